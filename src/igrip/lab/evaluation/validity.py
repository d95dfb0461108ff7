"""Whether a hand or an object was detected well enough for a valid trial (SPEC §7)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from igrip.lab.evaluation.trials import longest_run

RUN = 3  # consecutive detections that count as found
MAX_MISSED = 3  # frames in a row that may be missed afterwards
EARLY_SECONDS, EARLY_PART = 0.5, 0.5


class DetectionQuality(NamedTuple):
    """How well one thing was detected in a trial.

    Attributes
    ----------
    found : float or None
        Time at which it was first found [s].
    early : bool
        Whether enough of the trial was left then.
    max_gap : int
        Number of frames in the longest gap afterwards.
    """

    found: float | None
    early: bool
    max_gap: int

    @property
    def problem(self) -> str | None:
        """Why this is not enough; None if it is."""
        if self.found is None:
            return "never found"
        if not self.early:
            return "found too late"
        if self.max_gap > MAX_MISSED:
            return f"missed in more than {MAX_MISSED} frames in a row"
        return None


def assess_detection(
    times: Sequence[float], detected: Sequence[bool], begin: float, end: float
) -> DetectionQuality:
    """Assess the detections of one thing between two times.

    Found: at the start of the first run of 3 consecutive detections. Early: more than 0.5 s, or
    more than half of the trial, remained then. Gaps count from there to the end of the trial.

    Parameters
    ----------
    times : (n,)
        Of the frames in which it was looked for, increasing [s].
    detected : (n,)
        Whether it was detected in each.
    begin, end : float
        Of the trial [s].
    """
    all_times = np.asarray(times, dtype=np.float64)
    within = (all_times >= begin) & (all_times <= end)
    all_times, flags = all_times[within], np.asarray(detected, dtype=bool)[within]
    if len(flags) < RUN:
        return DetectionQuality(None, False, 0)
    runs = np.flatnonzero(np.convolve(flags, np.ones(RUN), "valid") == RUN)
    if not len(runs):
        return DetectionQuality(None, False, 0)
    first = int(runs[0])
    left = end - float(all_times[first])
    early = left > EARLY_SECONDS or left > EARLY_PART * (end - begin)
    return DetectionQuality(float(all_times[first]), early, longest_run(~flags[first:])[1])
