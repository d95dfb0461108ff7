"""A loop with a WebSocket server at work, on a clock that a test sets."""

from __future__ import annotations

import json
import random
import threading

from websockets.sync.client import connect

import igrip
from igrip.runtime.clock_sync import ArrivalClock
from igrip.runtime.inputs import INPUTS
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from runtime_fakes import PATIENCE, Clock, until
from support import BOX, UPRIGHT

POSE = {"model": BOX, "position": [0.3, 0.0, 0.0], "orientation": UPRIGHT}


def observation(k, t=None):
    position = [0.004 * k, 0.01 * random.Random(k).random(), 0.0]
    return {
        "t": 5e3 + k / 30.0 if t is None else t, "hands": {"right": {"position": position}},
        "objects": {"box": POSE},
    }  # fmt: skip


def receive(client):
    return json.loads(client.recv(timeout=PATIENCE))


class Running:
    """A loop at work in threads of this process, on a clock that the test sets."""

    def __init__(self, catalog, token=None, assisted=("*",), observations=True, works=True):
        config = igrip.Config(targets="paper", commitment={"assisted": assisted, "reliability": 0})
        self.clock, self.updates = Clock(), 0
        self.warnings = []
        options = Options(port=0, token=token)
        self.loop = Loop(
            igrip.Estimator(catalog, config), ArrivalClock(clock=self.clock),
            {"ws": INPUTS.get("ws")(options)} if observations else {},
            {"ws": OUTPUTS.get("ws")(options)}, warn=lambda text: self.warnings.append(text),
        )  # fmt: skip
        self.server = options.shared["websocket"]
        self.loop.__enter__()
        self.thread = threading.Thread(target=self.loop.run, args=(self._updated,), daemon=True)
        if works:
            self.thread.start()

    def _updated(self, intentions):
        self.updates += 1

    def client(self, path, **options):
        return connect(f"ws://127.0.0.1:{self.server.port}{path}", compression=None, **options)

    def listener(self, path="/intentions"):
        """Return a client that is among those that intentions go to."""
        before = self.server.counts()["clients"]
        client = self.client(path)
        until(lambda: self.server.counts()["clients"] > before)
        return client

    def pass_time(self, seconds):
        """Let time pass, and wait for the tick that notices it."""
        before = self.updates
        self.clock.t += seconds
        until(lambda: self.updates > before)

    def feed(self, source, k, encode=json.dumps):
        """Send an observation a thirtieth of a second after the last, and wait for its update."""
        before = self.updates
        self.clock.t += 1.0 / 30.0
        source.send(encode(observation(k)))
        until(lambda: self.updates > before)

    def close(self):
        self.loop.finish()
        if self.thread.ident is not None:
            self.thread.join(PATIENCE)
            assert not self.thread.is_alive()
        self.loop.__exit__()
