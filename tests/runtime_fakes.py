"""Outputs and clocks of the tests of the runtime."""

from __future__ import annotations

import time

from igrip.observation import Observation
from igrip.runtime.loop import Sender
from support import BOX, UPRIGHT

SENDER = Sender()
OPEN = []  # outlets of LSL of tests that have ended
PATIENCE = 60.0  # s that a test waits for what must come, on however slow a machine


def until(condition):
    """Wait for a condition; it is a failure if it does not come true."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.002)


def stays_open(outlet):
    """Return an outlet of LSL that is destroyed after all tests, when nobody connects to it.

    liblsl 1.18 now and then crashes a process that destroys an outlet while a reader connects or
    leaves: its list of connections is changed and walked through at once.
    """
    OPEN.append(outlet)
    return outlet


class Clock:
    """A clock that stands still until it is set."""

    def __init__(self, t=0.0):
        self.t = t

    def __call__(self):
        return self.t


class Collector:
    """An output that keeps what is sent, as it is when it is sent."""

    def __init__(self):
        self.intentions, self.messages = [], []
        self.closed = False

    def start(self, loop):
        pass

    def send(self, envelope):
        self.intentions.append(envelope.intention)
        self.messages.append(envelope.to_dict())

    def close(self):
        self.closed = True

    def counts(self):
        return {"sent": len(self.messages), "lost": 0}


def reach(count=60, ids=("right",)):
    """Yield messages of a reach towards a box, at 30 Hz."""
    for k in range(count):
        yield Observation(
            t=k / 30.0,
            hands={id: {"position": [0.005 * k, 0.002 * (k % 3), 0.0]} for id in ids},
            objects={"box": {"model": BOX, "position": [0.3, 0.0, 0.0], "orientation": UPRIGHT}},
        )
