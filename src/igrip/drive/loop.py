"""The loop of a device: messages, the user's say and time, handled by one thread."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

from igrip.drive.receiver import Receiver
from igrip.drive.supervisor import Supervisor
from igrip.runtime.bounded_queue import BoundedQueue

TICK = 0.004  # s
MAX_WAITING = 64  # messages; older ones could permit nothing any more

Order = Literal["veto", "confirm", "stop", "resume", "lost", "end"]


class _Item(NamedTuple):
    what: Any
    arrived: float


class DriveLoop:
    """Feeds a supervisor, from the thread that calls :meth:`run`.

    Parameters
    ----------
    supervisor : Supervisor
        With an open device.
    receiver : Receiver
        On the same clock.
    clock : function
        A monotonic clock [s].
    """

    def __init__(
        self, supervisor: Supervisor, receiver: Receiver,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:  # fmt: skip
        self.supervisor, self.receiver = supervisor, receiver
        self._clock = clock
        self._queue: BoundedQueue[_Item] = BoundedQueue(MAX_WAITING)
        self._ended = False
        self._report: dict[str, Any] = {}

    def submit(self, message: Any) -> None:
        """Queue a message; from any thread."""
        self._queue.put(_Item(message, self._clock()), "messages")

    def order(self, order: Order) -> None:
        """Queue what the user or the connection says; it overtakes messages. From any thread."""
        self._queue.put(_Item(order, self._clock()), "orders", urgent=order != "lost")

    def run(self, on_tick: Callable[[], None] = lambda: None, until: float | None = None) -> None:
        """Work until the order ``end``, or a time on the clock [s].

        Parameters
        ----------
        on_tick : function
            Called after each step; must not block.
        """
        while not self._ended and (until is None or self._clock() < until):
            self.step(TICK)
            on_tick()

    def step(self, timeout: float) -> None:
        """Handle one item, if one comes within ``timeout`` [s], and what is due."""
        item = self._queue.get(timeout)
        if item is None:
            pass
        elif isinstance(item.what, str):
            self._obey(item.what)
        else:
            decision = self.receiver.read(item.what, item.arrived)
            if decision is not None:
                self.supervisor.receive(decision)
        self.supervisor.step()

    def _obey(self, order: str) -> None:
        if order == "end":
            self._ended = True
            self.supervisor.lose()
        elif order == "lost":
            self.supervisor.lose()
        elif order in ("veto", "confirm", "stop", "resume"):
            getattr(self.supervisor, order)()

    def status(self) -> dict[str, Any]:
        """Return what the device does, and counts of messages; from any thread."""
        return self.supervisor.status() | {
            "messages": dict(self.receiver.counts), "queue": self._queue.report(),
        }  # fmt: skip
