"""The estimator at work on a live stream: every observation at once, words about leases between."""

from __future__ import annotations

import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable
from typing import Any, Protocol

from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.observation import Observation
from igrip.runtime.envelope import Sequencer
from igrip.runtime.latency import LatencyMeter
from igrip.runtime.outputs import Output
from igrip.runtime.protocol import METHODS, Command


class Recorder(Protocol):
    """Takes the estimator's input, and what it said."""

    def write(self, message: Observation | Intention) -> None:
        """Write one message."""
        ...


class Loop:
    """One estimator and its outputs.

    Parameters
    ----------
    estimator : Estimator
        New.
    begin : float
        When the stream's times begin, on ``clock`` [s].
    recorder : Recorder, optional
        Is given every observation before the estimator is: what was recorded can be replayed.
    clock : function
        A monotonic clock [s].

    Attributes
    ----------
    estimator : Estimator
        At work.
    latency : LatencyMeter
        From the exposure of a hand to the intention that follows from it.
    """

    def __init__(
        self, estimator: Estimator, begin: float, recorder: Recorder | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:  # fmt: skip
        self.estimator, self._begin, self._recorder = estimator, begin, recorder
        self._clock = clock
        self._words: deque[Command] = deque(maxlen=64)
        self._lock = threading.Lock()
        self.numbering = Sequencer(clock)
        self.outputs: list[Output] = []
        self.latency = LatencyMeter()
        self.counts: Counter[str] = Counter()

    def word(self, message: Observation | Command, sender: object = None) -> None:
        """Take a word about a lease, from any thread; observations from outside are not taken."""
        if isinstance(message, Command):
            self._words.append(message)
        else:
            self.count("refused")

    def count(self, what: str) -> None:
        """Count something that befell what came in, from any thread."""
        with self._lock:
            self.counts[what] += 1

    def run(
        self,
        stream: Iterable[Observation],
        look: Callable[[list[Intention]], None] = lambda intentions: None,
    ) -> None:
        """Work until the stream ends.

        Parameters
        ----------
        stream : iterable of Observation
            Live.
        look : function
            Called after each update with what was said; must not wait.
        """
        for observation in stream:
            while self._words:
                self._say(self._words.popleft())
            if self._recorder is not None:
                self._recorder.write(observation)
            begin = self._clock()
            intentions = self.estimator.update(observation)
            now = self._clock()
            exposed = [h.t for h in observation.hands.values() if h is not None and h.t is not None]
            if exposed:
                self.latency.note(now, now - begin, now - self._begin - max(exposed))
            self._tell(intentions, begin)
            look(intentions)

    def _say(self, control: Command) -> None:
        self.count(control.word)
        try:
            self._tell(getattr(self.estimator, METHODS[control.word])(control.hand), self._clock())
        except IgripError:
            self.count("refused")

    def _tell(self, intentions: list[Intention], arrived: float) -> None:
        for intention in intentions:
            self.count("intentions")
            if not self.outputs:
                continue
            envelope = self.numbering.take(intention, arrived)
            for output in list(self.outputs):
                try:
                    output.send(envelope)
                except BrokenPipeError:  # one reader went; the others stay
                    self.outputs.remove(output)

    def report(self) -> dict[str, Any]:
        """Return what was counted, and the latency from exposure to intention."""
        with self._lock:
            counts = dict(self.counts)
        told = self.latency.summary()
        return {"counts": counts, "update": told}
