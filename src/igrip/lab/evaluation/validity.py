"""Whether a hand or an object was detected well enough for a valid trial (SPEC §7)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from igrip.lab.evaluation.trials import longest_run

RUN = 3  # consecutive detections that count as found
MAX_MISSED = 3  # frames in a row that may be missed afterwards
EARLY_SECONDS, EARLY_PART = 0.5, 0.5


class Detection(NamedTuple):
    """When one thing was first found in a trial [s], and why that is not enough; None: it is."""

    found: float | None
    problem: str | None


def assess_detection(
    times: Sequence[float], detected: Sequence[bool], begin: float, end: float
) -> Detection:
    """Assess the detections (n,) of one thing at times (n,) of frames between two times [s].

    Found: at the start of the first run of 3 consecutive detections. Not too late: more than 0.5 s,
    or more than half of the trial, remained then. Gaps count from there to the end of the trial.
    """
    frames = [flag for t, flag in zip(times, detected, strict=True) if begin <= t <= end]
    runs = [k for k in range(len(frames) - RUN + 1) if all(frames[k : k + RUN])]
    if not runs:
        return Detection(None, "never found")
    found = [t for t in times if begin <= t <= end][runs[0]]
    problem = None
    if end - found <= EARLY_SECONDS and end - found <= EARLY_PART * (end - begin):
        problem = "found too late"
    elif longest_run(~np.array(frames[runs[0] :], dtype=bool))[1] > MAX_MISSED:
        problem = f"missed in more than {MAX_MISSED} frames in a row"
    return Detection(float(found), problem)
