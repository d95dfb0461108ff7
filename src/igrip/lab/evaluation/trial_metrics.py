"""One trial judged: what it was, whether it was seen well enough, and how each estimator did."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import PlacedObject
from igrip.intention import Intention
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.calibration import BINS
from igrip.lab.evaluation.movement import movement_bounds, smooth_speeds
from igrip.lab.evaluation.trials import causal_accuracy, score_trial
from igrip.lab.evaluation.validity import MAX_MISSED, sight
from igrip.observation import Observation

Array = NDArray[np.float64]
FRACTIONS = (0.20, 0.30, 0.40, 0.50, 0.60, 0.70, 0.85, 1.00)
NO_REACH = "none"
SLACK = 0.1  # a recording may end this much before the movement [s]


@dataclass
class Seen:
    """What a recording holds of one trial, gathered message by message.

    Attributes
    ----------
    times, hand : lists
        Time of each message [s], and whether the task's hand was measured in it.
    looked, target : lists
        Times at which the target was looked for [s], and whether it was seen.
    trace_times, trace : lists
        Raw measurements of the hand [s, m].
    objects : set of str
        Ids of all objects that were ever seen.
    """

    hand_id: str | None
    target_id: str | None
    times: list[float] = field(default_factory=list)
    hand: list[bool] = field(default_factory=list)
    looked: list[float] = field(default_factory=list)
    target: list[bool] = field(default_factory=list)
    trace_times: list[float] = field(default_factory=list)
    trace: list[tuple[float, float, float]] = field(default_factory=list)
    objects: set[str] = field(default_factory=set)
    observed: int = 0

    def take(self, observation: Observation) -> None:
        """Note one message."""
        hand = observation.hands.get(self.hand_id) if self.hand_id else None
        self.times.append(observation.t)
        self.hand.append(hand is not None)
        if hand is not None:
            t = observation.t if hand.t is None else hand.t
            if not self.trace_times or t > self.trace_times[-1]:
                self.trace_times.append(t)
                self.trace.append(hand.position)
        complete = hand is not None
        if self.target_id is not None and self.target_id in observation.objects:
            self.looked.append(observation.t)
            self.target.append(observation.objects[self.target_id] is not None)
            complete &= self.target[-1]
        self.observed += complete
        self.objects |= {id for id, pose in observation.objects.items() if pose is not None}

    def bounds(self, trial: Trial) -> tuple[float, float] | None:
        """Return onset and end: those of the table, or else those of the filtered raw trace [s]."""
        if trial.onset_s is not None and trial.end_s is not None:
            return trial.onset_s, trial.end_s
        if len(self.trace) < 3:
            return None
        times, speeds = smooth_speeds(np.array(self.trace_times), np.array(self.trace))
        return movement_bounds(times, speeds, noisy=True)

    def looks(self, begin: float, end: float) -> tuple[list[float], list[bool]]:
        """Return when the target was looked for, and seen; a source gone silent is one that misses.

        A target that was told just once, for good, needs no second look.
        """
        if len(self.looked) < 2:
            once = self.target == [True]
            return ([begin, *self.times[1:3]], [True] * 3) if once else (self.looked, self.target)
        usual = float(np.median(np.diff(self.looked)))
        times, seen = [], []
        for t, is_seen, after in zip(
            self.looked, self.target, [*self.looked[1:], end], strict=True
        ):
            silent = int((after - t) / usual - 1e-6) if after - t > max(0.3, 3.0 * usual) else 0
            times += [t, *(t + usual * (k + 1) for k in range(min(silent, MAX_MISSED + 1)))]
            seen += [is_seen, *[False] * min(silent, MAX_MISSED + 1)]
        return times, seen


def describe_trial(
    trial: Trial, seen: Seen, bounds: tuple[float, float] | None, objects: Sequence[PlacedObject]
) -> dict[str, Any]:
    """Return what does not hang on any estimator: task, validity, layout of the objects."""
    side = trial.camera_side
    row: dict[str, Any] = {
        "recording": trial.recording, "participant": trial.participant, "trial": trial.trial,
        "camera": trial.camera, "camera_side": side, "hand": trial.hand, "target": trial.target,
        "grip": trial.grip, "movement": trial.movement,
        "view": _view(side, trial.hand),
        "group": trial.extra.get("distance"), "messages": len(seen.times),
        "observed": seen.observed / max(1, len(seen.times)), "objects": len(seen.objects),
        "seconds": seen.times[-1] - seen.times[0] if seen.times else 0.0,
    }  # fmt: skip
    if bounds is None:
        return row
    onset, end = bounds
    begin = seen.times[0] if seen.times else 0.0
    hand = sight(np.array(seen.times), np.array(seen.hand, dtype=bool), begin, end)
    looked, was_seen = seen.looks(begin, end)
    target = sight(np.array(looked), np.array(was_seen, dtype=bool), begin, end)
    cut = coverage(seen, bounds)
    reasons = [cut] if cut else []
    reasons += [f"hand {hand.reason}"] if hand.reason else []
    reasons += [f"target {target.reason}"] if target.reason else []
    row |= {
        "onset_s": onset, "end_s": end, "movement_s": end - onset,
        "bounds": "trace" if None in (trial.onset_s, trial.end_s) else "table",
        "valid": not reasons,
        "invalid_reason": "; ".join(reasons) or None,
        "both_seen_0.3s_before_end": all(
            s.found is not None and s.found <= end - 0.3 for s in (hand, target)
        ),
    }  # fmt: skip
    return row | _gaps(trial, seen, onset, objects)


def coverage(seen: Seen, bounds: tuple[float, float]) -> str | None:
    """Say which part of the movement a recording does not hold; None: it holds all of it."""
    if not seen.times or seen.times[-1] < bounds[1] - SLACK:
        return "the recording ends before the movement does"
    return "the recording begins after the movement does" if seen.times[0] > bounds[0] else None


def _view(side: str | None, hand: str | None) -> str | None:
    """Return whether the camera stood on the side of the hand."""
    if side not in ("left", "right") or hand not in ("left", "right"):
        return None
    return "ipsi" if side == hand else "contra"


def _gaps(
    trial: Trial, seen: Seen, onset: float, objects: Sequence[PlacedObject]
) -> dict[str, float | None]:
    """Return how far the target's neighbour in sight is from it, in angle [deg] and depth [m]."""
    before = [p for t, p in zip(seen.trace_times, seen.trace, strict=True) if t <= onset]
    centres = {placed.id: placed.centre for placed in objects}
    target = centres.pop(trial.target or "", None)
    if target is None or not centres or not seen.trace:
        return {"angular_gap_deg": None, "depth_gap_m": None}
    start = np.mean(before, axis=0) if before else np.array(seen.trace[0])
    towards = target - start
    others = np.array(list(centres.values())) - start
    lengths = np.linalg.norm(others, axis=1)
    cosines = others @ towards / (lengths * np.linalg.norm(towards))
    nearest = int(np.argmax(cosines))
    angle = float(np.degrees(np.arccos(np.clip(cosines[nearest], -1.0, 1.0))))
    depth = float(lengths[nearest] - np.linalg.norm(towards))
    return {"angular_gap_deg": angle, "depth_gap_m": depth}


def judge(
    trial: Trial,
    bounds: tuple[float, float] | None,
    intentions: Sequence[Intention],
    last: float = math.inf,
) -> dict[str, Any]:
    """Return how one estimator did in one trial; keys are documented in ``docs/evaluation.md``.

    ``last`` is the time of the recording's last message [s]: what was not recorded cannot be right.
    """
    own = [i for i in intentions if i.hand == trial.hand]
    if trial.target in (None, NO_REACH) or bounds is None:
        return _judge_no_reach(intentions) if trial.target == NO_REACH else {}
    onset, end = bounds
    times = np.array([i.t for i in own])
    right = np.array([i.target == trial.target for i in own], dtype=bool)
    # the grip of the *predicted* target, whichever it is (SPEC §7)
    grip = np.array([i.grip is not None and i.grip == trial.grip for i in own], dtype=bool)
    possible = np.array([i.status in ("idle", "reaching", "holding") for i in own], dtype=bool)
    row: dict[str, Any] = {"answers": len(own)}
    first = times[possible][0] if possible.any() else np.inf
    counted = (times >= first) & (times <= end)
    row["frames_possible"] = int(counted.sum())
    row["frames_right"] = int(right[counted].sum())
    if trial.grip is not None:
        row["grip_frames_right"] = int(grip[counted].sum())
    whole = last >= end - SLACK
    for name, flags in (("", right), ("grip_", grip)):
        if name and trial.grip is None:
            continue
        score = score_trial(times, flags, onset, end)
        row |= {
            f"{name}success": score.success and whole, f"{name}ratio": score.ratio,
            f"{name}found_s": score.found, f"{name}delay_s": score.delay,
            f"{name}delay_clipped_s": None if score.delay is None else max(0.0, score.delay),
            f"{name}margin_s": score.margin,
        }  # fmt: skip
        at = causal_accuracy(times, flags, onset, end, FRACTIONS)
        at &= onset + np.array(FRACTIONS) * (end - onset) <= last + SLACK
        row |= {f"{name}right_at_{f:.0%}": bool(x) for f, x in zip(FRACTIONS, at, strict=True)}
    return row | _calibration(trial, [i for i in own if onset <= i.t <= end])


def _judge_no_reach(intentions: Sequence[Intention]) -> dict[str, Any]:
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


def _calibration(trial: Trial, intentions: Sequence[Intention]) -> dict[str, Any]:
    """Return sums from which calibration error and Brier score are pooled over trials."""
    given: list[tuple[float, bool]] = []
    brier = 0.0
    for intention in intentions:
        probability: Mapping[str, float] | None = intention.probability
        if not probability:
            continue
        best = max(probability, key=lambda id: probability[id])
        given.append((probability[best], best == trial.target))
        brier += sum((p - (id == trial.target)) ** 2 for id, p in probability.items())
        brier += 0.0 if trial.target in probability else 1.0
    if not given:
        return {}
    confidence, right = np.array([c for c, _ in given]), np.array([r for _, r in given])
    index = np.minimum((confidence * BINS).astype(int), BINS - 1)
    return {
        "calibration_n": np.bincount(index, minlength=BINS).tolist(),
        "calibration_stated": np.bincount(index, weights=confidence, minlength=BINS).tolist(),
        "calibration_right": np.bincount(index, weights=right, minlength=BINS).tolist(),
        "brier_sum": brier, "brier_n": len(given),
    }  # fmt: skip
