"""How one trial went: its detections, success, delay, margin, accuracy on the way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.float64]
Flags = NDArray[np.bool_]
SUCCESS_RATIO = 0.70
RUN = 3  # consecutive detections that count as found
MAX_MISSED = 3  # frames in a row that may be missed afterwards
EARLY_SECONDS, EARLY_PART = 0.5, 0.5


class TrialScore(NamedTuple):
    """The paper's verdict on one trial."""

    success: bool  # right in more than 70 % of the frames from k_target to k_f
    ratio: float  # that part; 0 where no frame was right
    found: float | None  # k_target, the first frame of the longest run of right ones [s]
    delay: float | None  # from onset to k_target; negative if it is before [s]
    margin: float | None  # from k_target to the end [s]


def longest_run(correct: Flags) -> tuple[int, int]:
    """Return first index and length of the longest run of True; the earliest if tied.

    An array without True gives ``(0, 0)``.
    """
    padded = np.concatenate(([False], correct, [False]))
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    starts, lengths = edges[::2], edges[1::2] - edges[::2]
    if not len(starts):
        return 0, 0
    longest = int(np.argmax(lengths))
    return int(starts[longest]), int(lengths[longest])


def score_trial(times: Times, correct: Flags, onset: float, end: float) -> TrialScore:
    """Score one trial as the paper does (its "Trial evaluation"; docs/evaluation.md).

    ``times`` (n,) are those of the frames, increasing [s]; ``correct`` (n,) states whether the
    prediction was right in each. Frames after the end (k_f) do not count.
    """
    within = times <= end
    times, correct = times[within], correct[within]
    first, length = longest_run(correct)
    if not length:
        return TrialScore(False, 0.0, None, None, None)
    ratio = float(correct[first:].mean())
    found = float(times[first])
    return TrialScore(ratio > SUCCESS_RATIO, ratio, found, found - onset, float(times[-1]) - found)


def causal_accuracy(
    times: Times, correct: Flags, onset: float, end: float, fractions: Sequence[float]
) -> Flags:
    """Return whether the newest prediction was right at fractions of the movement, from 0 to 1.

    False where there was no prediction yet. For the other parameters see :func:`score_trial`.
    """
    at = onset + np.asarray(fractions, dtype=np.float64) * (end - onset)
    # times come as decimal text: a frame that falls on the instant must not be missed by rounding
    index = np.searchsorted(times, at + 1e-9, side="right") - 1
    return np.array([bool(i >= 0 and correct[i]) for i in index], dtype=np.bool_)


class Detection(NamedTuple):
    """When a hand or object was first found in a trial [s], and why that is not enough, if so."""

    found: float | None
    problem: str | None


def assess_detection(
    times: Sequence[float], detected: Sequence[bool], begin: float, end: float
) -> Detection:
    """Assess the detections (n,) of a hand or object at frames (n,) between two times [s].

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
