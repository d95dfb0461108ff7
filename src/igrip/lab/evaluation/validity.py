"""Was a trial seen well enough to be judged? The paper's rules (SPEC §7)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.float64]
Flags = NDArray[np.bool_]
RUN = 3  # consecutive detections that count as found
MAX_MISSED = 3  # frames in a row that may be missed afterwards
EARLY_SECONDS, EARLY_PART = 0.5, 0.5


class Sight(NamedTuple):
    """How well one thing was seen in a trial.

    Attributes
    ----------
    found : float or None
        Time at which it was first found [s].
    early : bool
        Whether enough of the trial was left then.
    max_gap : int
        Longest row of frames in which it was missed afterwards.
    """

    found: float | None
    early: bool
    max_gap: int

    @property
    def reason(self) -> str | None:
        """Why this is not enough, in words; None if it is."""
        if self.found is None:
            return "never found"
        if not self.early:
            return "found too late"
        if self.max_gap > MAX_MISSED:
            return f"missed in more than {MAX_MISSED} frames in a row"
        return None


def sight(times: Times, detected: Flags, begin: float, end: float) -> Sight:
    """Judge how well one thing was seen between two times.

    Found: at the start of the first run of 3 consecutive detections. Early: more than 0.5 s, or
    more than half of the trial, remained then. Gaps count from there to the end of the trial.

    Parameters
    ----------
    times : (n,)
        Of the frames in which it was looked for, increasing [s].
    detected : (n,)
        Whether it was seen in each.
    begin, end : float
        Of the trial [s].
    """
    within = (times >= begin) & (times <= end)
    times, detected = times[within], detected[within]
    runs = np.flatnonzero(np.convolve(detected, np.ones(RUN), "valid") == RUN) if (
        len(detected) >= RUN
    ) else np.empty(0, dtype=int)  # fmt: skip
    if not len(runs):
        return Sight(None, False, 0)
    first = int(runs[0])
    left = end - float(times[first])
    early = left > EARLY_SECONDS or left > EARLY_PART * (end - begin)
    return Sight(float(times[first]), early, longest_row(~detected[first:]))


def longest_row(flags: Flags) -> int:
    """Return the length of the longest row of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)))
    return int((edges[1::2] - edges[::2]).max(initial=0))
