"""How one estimator did in one trial: success, delay, margin, frames, accuracy, calibration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from igrip.intention import Intention
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.calibration import ReliabilityBins, squared_error
from igrip.lab.evaluation.recorded_trial import SLACK, Bounds
from igrip.lab.evaluation.trial_description import NO_REACH
from igrip.lab.evaluation.trials import causal_accuracy, score_trial

FRACTIONS = (0.20, 0.30, 0.40, 0.50, 0.60, 0.70, 0.85, 1.00)


def score_answers(
    trial: Trial, bounds: Bounds | None, intentions: Sequence[Intention], last: float = math.inf
) -> dict[str, Any]:
    """Return the columns of one estimator in one trial (``docs/evaluation.md``).

    ``bounds`` are onset and end of the movement [s] or None; ``intentions`` of every hand, in
    order. What comes after ``last``, the time of the last message [s], cannot be correct.
    """
    if trial.target == NO_REACH:
        return _count_named_targets(intentions)
    if trial.target is None or bounds is None:
        return {}
    onset, end = bounds
    own = [i for i in intentions if i.hand == trial.hand]
    times = np.array([i.t for i in own])
    right = np.array([i.target == trial.target for i in own], dtype=bool)
    # the grip of the *predicted* target, whichever it is (paper, "Trial evaluation")
    grip = np.array([i.grip is not None and i.grip == trial.grip for i in own], dtype=bool)
    # a prediction was possible: the hand is followed, and some object can be used
    following = ("idle", "reaching", "holding")
    possible = np.array([i.status in following and bool(i.scores) for i in own], dtype=bool)
    first = times[possible][0] if possible.any() else np.inf
    counted = (times >= first) & (times <= end)
    row: dict[str, Any] = {
        "answers": len(own),
        "frames_possible": int(counted.sum()),
        "frames_right": int(right[counted].sum()),
    }
    if trial.grip is not None:
        row["grip_frames_right"] = int(grip[counted].sum())
    recorded_to_the_end = last >= end - SLACK
    for name, flags in (("", right), ("grip_", grip)):
        if name and trial.grip is None:
            continue
        score = score_trial(times, flags, onset, end)
        row |= {
            f"{name}success": score.success and recorded_to_the_end, f"{name}ratio": score.ratio,
            f"{name}found_s": score.found, f"{name}delay_s": score.delay,
            f"{name}delay_clipped_s": None if score.delay is None else max(0.0, score.delay),
            f"{name}margin_s": score.margin,
        }  # fmt: skip
        at = causal_accuracy(times, flags, onset, end, FRACTIONS)
        at &= onset + np.array(FRACTIONS) * (end - onset) <= last + SLACK
        row |= {f"{name}right_at_{f:.0%}": bool(x) for f, x in zip(FRACTIONS, at, strict=True)}
    return row | _calibration(trial.target, [i for i in own if onset <= i.t <= end])


def _count_named_targets(intentions: Sequence[Intention]) -> dict[str, Any]:
    """Count how often a target was named although nobody reached for anything."""
    named = [i.target is not None for i in intentions if i.status in ("idle", "reaching")]
    moving = [i.target is not None for i in intentions if i.status == "reaching"]
    none_first = [
        max(i.probability, key=lambda id: i.probability[id]) == NO_REACH  # type: ignore[index]
        for i in intentions if i.probability
    ]  # fmt: skip
    return {
        "answers": len(named), "named": sum(named), "reaching": len(moving),
        "named_reaching": sum(moving), "with_probability": len(none_first),
        "none_most_probable": sum(none_first),
    }  # fmt: skip


def _calibration(target: str, intentions: Sequence[Intention]) -> dict[str, Any]:
    """Return sums from which calibration error and Brier score are pooled over trials."""
    stated: list[float] = []
    correct: list[bool] = []
    brier = 0.0
    for intention in intentions:
        if intention.probability:
            likeliest, p = max(intention.probability.items(), key=lambda item: item[1])
            stated.append(p)
            correct.append(likeliest == target)
            brier += squared_error(intention.probability, target)
    if not stated:
        return {}
    bins = ReliabilityBins.of(stated, correct)
    return {
        "calibration_n": bins.answers.tolist(), "calibration_stated": bins.stated.tolist(),
        "calibration_right": bins.correct.tolist(),
        "brier_sum": brier, "brier_n": len(stated),
    }  # fmt: skip
