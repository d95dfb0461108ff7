"""What a trial was, whatever the estimator: task, validity, layout of the objects."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from igrip.geometry.scene import PlacedObject
from igrip.lab.evaluation.recorded_trial import Bounds, RecordedTrial
from igrip.lab.evaluation.trials import assess_detection

NO_REACH = "none"  # the target of a recording without a reach
SIDES = ("left", "right")
IN_TIME = 0.3  # before the end of the movement [s]


def find_problem(recorded: RecordedTrial, bounds: Bounds | None) -> str | None:
    """Return the reason why a trial cannot be scored; None if it can."""
    trial = recorded.trial
    if trial.performed == "no":
        return "was not performed"
    if trial.target is None:
        return "its target is not known"
    if not recorded.times:
        return "the recording is empty"
    if trial.target == NO_REACH:
        return None
    if trial.hand is None:
        return "its hand is not known"
    return None if bounds is not None else "its movement has no onset and end"


def find_remarks(recorded: RecordedTrial, bounds: Bounds | None) -> list[str]:
    """Return what is odd about a trial that is scored all the same."""
    trial = recorded.trial
    if trial.target in (None, NO_REACH):
        return []
    remarks = []
    if (trial.onset_s is None) != (trial.end_s is None):
        remarks.append("its onset or its end is missing, so both are those of the trace")
    if trial.camera_side not in (None, *SIDES):
        remarks.append(f"camera_side {trial.camera_side!r} is neither left nor right")
    if bounds is not None and (missing := recorded.missing_part(bounds)):
        remarks.append(missing)
    if not any(recorded.hand_detected):
        remarks.append(f"hand {trial.hand!r} was never seen")
    if trial.target not in recorded.objects:
        remarks.append(f"target {trial.target!r} never appears")
    return remarks


def describe_trial(
    recorded: RecordedTrial, bounds: Bounds | None, objects: Sequence[PlacedObject]
) -> dict[str, Any]:
    """Return the columns that do not depend on the estimator (``docs/evaluation.md``).

    ``bounds`` are onset and end of the movement [s] or None; ``objects`` those usable at onset.
    """
    trial, view = recorded.trial, None
    if trial.camera_side in SIDES and trial.hand in SIDES:  # the camera's side is that of the hand
        view = "ipsi" if trial.camera_side == trial.hand else "contra"
    row: dict[str, Any] = {
        "recording": trial.recording, "participant": trial.participant, "trial": trial.trial,
        "camera": trial.camera, "camera_side": trial.camera_side, "hand": trial.hand,
        "target": trial.target, "grip": trial.grip, "movement": trial.movement,
        "view": view, "group": trial.extra.get("distance"),
        "messages": len(recorded.times),
        "observed": recorded.observed / max(1, len(recorded.times)),
        "objects": len(recorded.objects), "seconds": recorded.seconds,
    }  # fmt: skip
    if bounds is None:
        return row
    onset, end = bounds
    begin = recorded.times[0] if recorded.times else 0.0
    hand = assess_detection(recorded.times, recorded.hand_detected, begin, end)
    target = assess_detection(*recorded.target_looks(begin, end), begin, end)
    missing = recorded.missing_part(bounds)
    reasons = [missing] if missing else []
    reasons += [f"hand {hand.problem}"] if hand.problem else []
    reasons += [f"target {target.problem}"] if target.problem else []
    row |= {
        "onset_s": onset, "end_s": end, "movement_s": end - onset,
        "bounds": "trace" if None in (trial.onset_s, trial.end_s) else "table",
        "valid": not reasons,
        "invalid_reason": "; ".join(reasons) or None,
        "both_seen_0.3s_before_end": all(
            one.found is not None and one.found <= end - IN_TIME for one in (hand, target)
        ),
    }  # fmt: skip
    return row | _gaps(recorded, onset, objects)


def _gaps(
    recorded: RecordedTrial, onset: float, objects: Sequence[PlacedObject]
) -> dict[str, float | None]:
    """Return angle [deg] and depth [m] between the target and its neighbour, from the start."""
    times, positions = np.array(recorded.hand_times), np.array(recorded.hand_positions)
    centres = {placed.id: placed.centre for placed in objects}
    target = centres.pop(recorded.trial.target or "", None)
    if target is None or not centres or not len(times):
        return {"angular_gap_deg": None, "depth_gap_m": None}
    before = positions[times <= onset]
    start = before.mean(axis=0) if len(before) else positions[0]
    towards = target - start
    others = np.array(list(centres.values())) - start
    lengths = np.linalg.norm(others, axis=1)
    cosines = others @ towards / (lengths * np.linalg.norm(towards))
    nearest = int(np.argmax(cosines))
    angle = float(np.degrees(np.arccos(np.clip(cosines[nearest], -1.0, 1.0))))
    depth = float(lengths[nearest] - np.linalg.norm(towards))
    return {"angular_gap_deg": angle, "depth_gap_m": depth}
