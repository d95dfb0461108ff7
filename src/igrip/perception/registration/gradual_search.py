"""A search that goes on beside tracking: some starts a frame, in the frame it began with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from igrip.perception.registration.fit import PoseFit
from igrip.perception.registration.search import Steps

FIT = 20  # a fit to the end costs about as much as so many starts


class Finished(NamedTuple):
    """What a search found."""

    fits: Mapping[str, PoseFit]  # by id, in the frame of the table
    t: float  # of the frame in which they are [s]


class GradualSearch:
    """A search that is done bit by bit.

    It counts starts and reads no clock: the same frames give the same poses at the same frame.

    Attributes
    ----------
    begun : float or None
        Time of the frame of the newest search [s].
    """

    def __init__(self) -> None:
        self.begun: float | None = None
        self._steps: Steps | None = None

    @property
    def busy(self) -> bool:
        """Whether a search is under way."""
        return self._steps is not None

    def begin(self, steps: Steps, t: float) -> None:
        """Begin a search in a frame of time ``t`` [s]; one that is under way ends."""
        self._steps, self.begun = steps, t

    def stop(self) -> None:
        """End without a result, and forget when it began."""
        self._steps, self.begun = None, None

    def go_on(self, budget: int | None) -> Finished | None:
        """Try so many starts, all of them if None; return what was found, if that was the last."""
        if self._steps is None or self.begun is None:
            return None
        spent = 0
        try:
            while budget is None or spent < budget:
                cost = next(self._steps)
                spent += cost + FIT if cost else 1
        except StopIteration as end:
            self._steps = None
            return Finished(end.value, self.begun)
        return None
