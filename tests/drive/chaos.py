"""Chaos on a virtual clock: sensors, messages, the line, the process and the user, all at once.

The observer sees what the sensors gave, what the estimator said, and what the device did. It knows
nothing of the supervisor.
"""

from __future__ import annotations

import heapq
import itertools
import json
import random
from collections import Counter

import igrip
from drive.lines import Line
from igrip.devices.serial import SerialDevice, SerialSettings
from igrip.devices.twins.serial import SerialTwin
from igrip.drive.receiver import Receiver
from igrip.drive.supervisor import Supervisor
from igrip.lab.simulation.demo import DemoPerson
from igrip.lab.simulation.faults import Fault, inject
from igrip.runtime.envelope import Sequencer
from observer import Observer
from runtime_fakes import Clock
from support import every_kind

STEP = 0.004  # s
HAND = "right"
LINE_DELAY = 0.025  # s at most; the supervisor's margin is 30 ms


class SlowLine(Line):
    """A line that may delay, double, damage or lose what it carries."""

    def __init__(self, twin, clock, world):
        super().__init__(twin)
        self.clock, self.world, self.waiting = clock, world, []

    def write(self, data):
        if self.broken:
            raise OSError("the port has gone")
        self.written.append(data)
        copies = 2 if self.world.hit("line doubles", 0.01) else 1
        if self.world.hit("line loses", 0.01):
            return len(data)
        if self.world.hit("line damages", 0.02):
            data = bytearray(data)
            data[random.randrange(len(data))] ^= 1 << random.randrange(8)
        late = random.uniform(0, LINE_DELAY) if self.world.hit("line delays", 0.02) else 0.0
        for _ in range(copies):
            heapq.heappush(self.waiting, (self.clock.t + late, len(self.written), bytes(data)))
        self.deliver()
        return len(data)

    def deliver(self):
        while self.waiting and self.waiting[0][0] <= self.clock.t:
            self.incoming += self.twin.receive(heapq.heappop(self.waiting)[2])
        if self.world.hit("reply is rubbish", 0.0005):
            self.incoming += random.randbytes(random.randrange(40))


class World:
    """Runs the estimator, a supervisor and a device for so many faults."""

    def __init__(self, catalog, seed, same_clock=True):
        random.seed(seed)
        self.clock, self.counts = Clock(0.0), Counter()
        self.catalog, self.seed = catalog, seed
        self.twin = SerialTwin(self.clock)
        self.line = SlowLine(self.twin, self.clock, self)
        self.observer = Observer()
        self.links = []  # messages on their way: (when, number, line)
        self.number = itertools.count()
        self.sequencer = Sequencer(self.clock)
        self.leases = []  # (given at, valid until)
        self.lease_messages = 0
        self.violations = []
        self.stopped_at = None
        self.hang_until = self.pause_until = self.broken_until = self.dead_until = -1.0
        self.start_supervisor()

    def hit(self, what, probability):
        if random.random() >= probability:
            return False
        self.counts[what] += 1
        return True

    def start_supervisor(self):
        """Begin as a new process does."""
        self.receiver = Receiver(HAND, self.clock, same_clock=True)
        settings = SerialSettings(ramp=0.1)
        self.device = SerialDevice(settings, self.clock, self.line)
        self.supervisor = Supervisor(self.device, settings.grip_names(), self.clock)
        try:
            self.device.open()
        except Exception:
            self.dead_until = self.clock.t + 0.5
            self.supervisor = None

    def run(self, faults, rate):
        """Run until so many faults have happened; sensor faults come at ``rate`` a second."""
        person = (moment.observation for moment in DemoPerson(self.catalog, self.seed))
        kinds = [*every_kind(rate), Fault("freeze", rate=0.02, lasts=1.2)]
        sensed = Counter()
        estimator = igrip.Estimator(self.catalog, igrip.Config(commitment={"reliability": 0.0}))
        for observation in inject(person, kinds, self.seed, sensed):
            while self.clock.t + STEP <= observation.t:
                self.clock.t += STEP
                self.step()
            self.observer.sent(json.loads(observation.to_json()))
            intentions = estimator.update(observation)
            for intention in intentions:
                self.observer.said(json.loads(intention.to_json()))
                self.emit(intention, observation.t)
            if self.hit("estimator starts anew", 0.0005):
                self.sequencer = Sequencer(self.clock)
            self.faults = sum(self.counts.values()) + sum(sensed.values())
            if self.faults >= faults:
                return
        raise AssertionError("the demo has ended")

    def emit(self, intention, arrived):
        if self.clock.t < self.pause_until:
            return
        message = self.sequencer.wrap(intention, arrived).to_dict() | {"sent": self.clock.t}
        if message["commitment"] is not None and intention.hand == HAND:
            self.leases.append((self.clock.t, intention.commitment.valid_until))
            self.lease_messages += 1
        if self.hit("message lost", 0.03):
            return
        line = json.dumps(message)
        if self.hit("message damaged", 0.02):
            place = random.randrange(len(line))
            line = line[:place] + chr(random.randrange(32, 127)) + line[place + 1 :]
        late = random.expovariate(8.0) if self.hit("message late", 0.05) else 0.0
        copies = 3 if self.hit("message repeated", 0.03) else 1
        for copy in range(copies):
            when = self.clock.t + late + copy * random.random()
            heapq.heappush(self.links, (when, next(self.number), line))

    def step(self):
        self.misfortunes()
        self.line.deliver()
        self.twin.tick()
        alive = self.supervisor is not None and self.clock.t >= self.hang_until
        while alive and self.links and self.links[0][0] <= self.clock.t:
            when, _, line = heapq.heappop(self.links)
            try:
                message = json.loads(line)
            except ValueError:
                message = None
            decision = self.receiver.read(message, max(when, 0.0))
            if decision is not None:
                self.supervisor.receive(decision)
        if alive:
            self.supervisor.step()
        self.judge()

    def misfortunes(self):
        t = self.clock.t
        if self.hit("messages pause", 0.0008):
            self.pause_until = t + random.uniform(0.05, 0.6)
        if self.hit("process hangs", 0.0008):
            self.hang_until = t + random.uniform(0.02, 1.0)
        if self.hit("port goes", 0.0005):
            self.broken_until = t + random.uniform(0.02, 0.5)
        self.line.broken = t < self.broken_until
        if self.hit("device has a fault", 0.0002):
            self.twin.fault = True
        elif self.twin.fault and random.random() < 0.01:
            self.twin.fault = False
        if self.supervisor is None:
            if t >= self.dead_until:
                self.start_supervisor()
            return
        if self.hit("process killed", 0.0004):
            self.supervisor, self.dead_until = None, t + random.uniform(0.1, 0.5)
            self.line.incoming = b""
            return
        if t < self.hang_until:
            return
        if self.hit("veto", 0.0008):
            self.supervisor.veto()
        if self.hit("stop", 0.0003):
            self.supervisor.stop()
            self.stopped_at = t
        if (self.supervisor.stopped or self.supervisor.fault) and random.random() < 0.01:
            self.supervisor.resume()
            self.stopped_at = None

    def judge(self):
        """Hold what the device does against what was said."""
        t = self.clock.t
        if self.supervisor is None:
            self.stopped_at = None
        if not self.twin.active:
            return
        self.leases = [lease for lease in self.leases if lease[1] > t - 1.0]
        if not any(begin <= t <= end + 1e-9 for begin, end in self.leases):
            self.violations.append(f"{t:.3f}: it acts without a lease")
        if self.stopped_at is not None and t - self.stopped_at > 0.151:
            self.violations.append(f"{t:.3f}: it acts although it was stopped")


def check(world):
    """Return what is wrong with a run."""
    found = list(world.violations) + world.observer.violations
    if len(world.twin.accepted) > world.lease_messages:
        found.append("more actions than leases")
    allows = sum(frame[3] == 1 for frame in world.line.written)
    if len(world.twin.accepted) > allows:
        found.append("a frame was acted on twice")
    return found
