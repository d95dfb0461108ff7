"""The estimator at work for others: takes what came, ticks in silence, hands on what it says."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from igrip.errors import IgripError, ObservationError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.observation import Observation
from igrip.runtime.clock_sync import ArrivalStamp, SenderStamp
from igrip.runtime.envelope import Clock, Sequencer
from igrip.runtime.inbox import Inbox
from igrip.runtime.outputs import Output
from igrip.runtime.protocol import METHODS, Command

TICK = 0.05  # s of silence after which the estimator is told that time passes (DESIGN §3)
MAX_SENDERS = 64  # whose clocks are remembered


class Service:
    """One estimator, its inbox and its outputs.

    Parameters
    ----------
    estimator : Estimator
        New.
    senders_clock : bool
        True: times are those of the one sender (a recording that is piped in). False: messages are
        stamped as they arrive.
    clock : function
        A monotonic clock [s].
    """

    def __init__(
        self, estimator: Estimator, senders_clock: bool = False, clock: Clock = time.monotonic
    ) -> None:
        self._estimator = estimator
        self._clock = clock
        self._begin = self._newest = clock()
        self._sender = SenderStamp() if senders_clock else None
        self._stamps: dict[object, ArrivalStamp] = {}
        self.inbox: Inbox[tuple[float, Observation | Command, object]] = Inbox()
        self.numbering = Sequencer(clock)
        self.outputs: list[Output] = []
        self._said = 0
        self._updated = self._begin
        self.answer: Callable[[object, ObservationError], None] = lambda sender, error: None
        self._report: dict[str, Any] = {}
        self._lock = threading.Lock()

    def take(
        self, message: Observation | Command, sender: object = None, wait: bool = False
    ) -> None:
        """Put what came into the inbox, with the time it came at; words overtake messages."""
        if isinstance(message, Command):
            self.inbox.put_first((self._clock(), message, sender))
        else:
            self.inbox.put((self._clock(), message, sender), wait, sender)

    def run(self, report: float | None = None) -> None:
        """Work until the inbox is closed and empty."""
        reported = self._clock()
        while not self.inbox.over:
            self.step(TICK)
            if report is not None and self._clock() - reported >= report:
                reported = self._clock()
                self._update_report()
        self._update_report()

    def step(self, timeout: float) -> None:
        """Take one message, and tell the estimator that time passes where none was of use."""
        item = self.inbox.get(timeout)
        if item is not None:
            arrived, message, sender = item
            # it may have come in the moment before a tick
            arrived = self._newest = max(arrived, self._newest)
            if isinstance(message, Command):
                self._word(message, arrived, sender)
            else:
                self._update(self._stamped(message, arrived, sender), arrived, sender)
        now = self._clock()
        if self._sender is None and now - self._updated >= TICK:
            self._newest = max(now, self._newest)
            self._update(Observation(t=self._newest - self._begin), self._newest, None)

    def _word(self, control: Command, arrived: float, sender: object) -> None:
        """Pass on a word about a lease; what it changes is told at once."""
        self.inbox.count(control.word)
        try:
            self._tell(getattr(self._estimator, METHODS[control.word])(control.hand), arrived)
        except IgripError as error:
            self.inbox.count("refused")
            self.answer(sender, ObservationError("hand", str(error)))

    def _stamped(self, message: Observation, arrived: float, sender: object) -> Observation:
        if self._sender is not None:
            return self._sender.stamp(message, arrived)
        stamp = self._stamps.pop(sender, None) or ArrivalStamp()
        if len(self._stamps) >= MAX_SENDERS:
            self._stamps.pop(next(iter(self._stamps)))  # who was silent for longest
        self._stamps[sender] = stamp
        return stamp.stamp(message, arrived - self._begin)

    def _update(self, message: Observation, arrived: float, sender: object) -> None:
        """Update; an object that is refused is left out alone, and its sender told."""
        while True:
            try:
                intentions = self._estimator.update(message)
                break
            except ObservationError as error:
                self.inbox.count("refused")
                self.answer(sender, error)
                if error.object_id is None:
                    return
                objects = dict(message.objects)
                del objects[error.object_id]
                message = Observation(t=message.t, hands=dict(message.hands), objects=objects)
        self._updated = self._clock()
        self._tell(intentions, arrived)

    def _tell(self, intentions: list[Intention], arrived: float) -> None:
        for intention in intentions:
            envelope = self.numbering.take(intention, arrived)
            for output in list(self.outputs):
                try:
                    output.send(envelope)
                except BrokenPipeError:  # one reader went; the others stay
                    self.outputs.remove(output)
                    if not self.outputs:
                        raise
            self._said += 1

    def _update_report(self) -> None:
        report = {
            "session": self.numbering.session, "intentions": self._said,
            "incoming": self.inbox.report(), "inputs": self._estimator.inputs(),
            "outputs": {type(o).__name__: o.counts() for o in self.outputs},
        }  # fmt: skip
        with self._lock:
            self._report = report

    def status(self) -> dict[str, Any]:
        """Return what was counted, as of the newest report; from any thread."""
        with self._lock:
            return dict(self._report)


def close(outputs: Sequence[Output]) -> None:
    """End every output."""
    for output in outputs:
        output.close()
