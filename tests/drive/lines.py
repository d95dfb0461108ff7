"""A virtual line between a device and its twin, and messages as igrip sends them."""

from __future__ import annotations

from igrip.devices.serial import SerialDevice, SerialSettings
from igrip.devices.twins.serial import SerialTwin
from igrip.drive.receiver import Receiver
from igrip.drive.supervisor import Supervisor


class Line:
    """Carries bytes at once, unless it is told to lose, change or refuse them."""

    def __init__(self, twin):
        self.twin, self.incoming = twin, b""
        self.change = lambda data: data
        self.broken = False
        self.written = []

    def write(self, data):
        if self.broken:
            raise OSError("the port has gone")
        self.written.append(data)
        arriving = self.change(data)
        if arriving:
            self.incoming += self.twin.receive(arriving)
        return len(data)

    def read(self, size):
        if self.broken:
            raise OSError("the port has gone")
        self.incoming += self.twin.tick()
        data, self.incoming = self.incoming[:size], self.incoming[size:]
        return data

    def close(self):
        pass


class Rig:
    """A supervisor, the serial device and its twin on one clock."""

    def __init__(self, clock, **settings):
        self.clock = clock
        self.twin = SerialTwin(clock)
        self.line = Line(self.twin)
        self.settings = SerialSettings(**settings)
        self.device = SerialDevice(self.settings, clock, self.line)
        self.device.open()
        self.said = []
        self.supervisor = Supervisor(
            self.device, self.settings.grip_names(), clock, say=self.said.append
        )
        self.receiver = Receiver("right", clock)
        self.sequence = 0

    def message(self, **changes):
        self.sequence += 1
        lease = {"target": "cup", "grip": "palmar", "since": 1.0, "valid_until": 2.0}
        return {
            "session": "a", "seq": self.sequence, "sent": self.clock(), "hand": "right",
            "status": "reaching", "target_model": "cup", "time_to_contact": 1.0,
            "commitment": lease, "valid_for": 0.12,
        } | changes  # fmt: skip

    def say(self, **changes):
        decision = self.receiver.read(self.message(**changes))
        if decision is not None:
            self.supervisor.receive(decision)
        return decision

    def wait(self, seconds, step=0.004):
        end = self.clock.t + seconds
        while self.clock.t < end - 1e-9:
            self.clock.t += step
            self.twin.tick()
            self.supervisor.step()


NOTHING = {"commitment": None, "valid_for": None}
