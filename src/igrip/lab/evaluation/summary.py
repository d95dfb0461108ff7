"""The rows of an evaluation summed up: the paper's table, and what it leaves out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd

from igrip.lab.evaluation import commitments
from igrip.lab.evaluation.calibration import BINS, interval_over_groups
from igrip.lab.evaluation.trial_metrics import FRACTIONS, NO_REACH

CONDITIONS = ("view", "movement", "grip", "hand", "target", "group", "participant")
COLUMNS = (
    "recording", "participant", "targets", "target", "problem", "remark", "valid", "group", "view",
    "movement", "grip", "hand", "success", "seconds", "messages", "observed", "objects",
    "both_seen_0.3s_before_end", "bounds",
)  # fmt: skip
MIN_PEOPLE = 5  # below it an interval over participants says nothing
ANGLES = (0.0, 10.0, 20.0, 40.0, 180.0)  # edges of the bins of the angular gap [deg]
DEPTHS = (-np.inf, -0.1, 0.0, 0.1, np.inf)  # of the depth gap [m]


def frame_of(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Return rows as a table."""
    frame = pd.DataFrame(list(rows))
    for column in COLUMNS:
        if column not in frame:
            frame[column] = None
    frame["participant"] = frame["participant"].fillna("unknown")
    return frame


def summarise(frame: pd.DataFrame, name: str, targets: Sequence[str]) -> dict[str, Any]:
    """Sum up an evaluation; the keys are documented in ``docs/evaluation.md``.

    Parameters
    ----------
    frame : DataFrame
        As :func:`frame_of` returns it.
    name : str
        Name of the dataset.
    targets : sequence of str
        The estimators, in the order of the report.
    """
    one = frame[frame["targets"] == targets[0]]  # what does not hang on the estimator
    broken = one[one["problem"].notna()]
    none = one[(one["target"] == NO_REACH) & one["problem"].isna()]
    reaches = one[(one["target"] != NO_REACH) & one["problem"].isna()]
    valid = reaches[reaches["valid"] == True]  # noqa: E712 - the column may hold None
    return {
        "schema": "igrip-summary/1",
        "dataset": name,
        "recordings": len(one),
        "excluded": [
            {"recording": r.recording, "participant": r.participant, "problem": r.problem}
            for r in broken.itertuples()
        ],
        "remarks": [
            {"recording": r.recording, "remark": r.remark}
            for r in one[one["remark"].notna()].itertuples()
        ],
        "reaches": len(reaches),
        "valid": len(valid),
        "valid_share": len(valid) / len(reaches) if len(reaches) else None,
        "invalid_reasons": _count(reaches, "invalid_reason"),
        "observed_share": _part(
            (reaches["observed"] * reaches["messages"]).sum(), reaches["messages"].sum()
        ),
        "bounds_from_trace": int((reaches["bounds"] == "trace").sum()),
        "movement_s": _mean(reaches.get("movement_s")),
        "no_reach_minutes": float(none["seconds"].sum()) / 60.0 if len(none) else 0.0,
        "targets": {
            target: _estimator(frame[(frame["targets"] == target) & frame["problem"].isna()])
            for target in targets
        },
    }


def _estimator(rows: pd.DataFrame) -> dict[str, Any]:
    reaches, none = rows[rows["target"] != NO_REACH], rows[rows["target"] == NO_REACH]
    valid = reaches[reaches["valid"] == True]  # noqa: E712
    in_time = reaches[reaches["both_seen_0.3s_before_end"] == True]  # noqa: E712
    return {
        "valid": scores(valid),
        "all": scores(reaches),
        "seen_in_time": scores(in_time),
        "by": {c: _by(valid, c) for c in CONDITIONS if valid[c].notna().any()}
        if len(valid)
        else {},
        "by_objects": _by(valid, "objects") if len(valid) else {},
        "by_angular_gap_deg": _binned(valid, "angular_gap_deg", ANGLES),
        "by_depth_gap_m": _binned(valid, "depth_gap_m", DEPTHS),
        "participants": _over_participants(valid),
        "no_reach": _no_reach(none),
        "calibration": _calibration(reaches),
        "commitment": _commitment(reaches, none),
    }


def scores(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the paper's numbers and causal accuracy over some trials, with intervals."""
    result: dict[str, Any] = {"trials": len(rows)} | dict.fromkeys(
        ("frames", "success", "success_interval", "delay_s", "delay_clipped_s", "margin_s")
    )
    if not len(rows) or "frames_possible" not in rows:
        return result
    result["frames"] = _part(rows["frames_right"].sum(), rows["frames_possible"].sum())
    if "grip_frames_right" in rows:
        asked = rows[rows["grip_frames_right"].notna()]
        part = _part(asked["grip_frames_right"].sum(), asked["frames_possible"].sum())
        result["grip_frames"] = part
    for prefix in ("", "grip_"):
        if f"{prefix}success" not in rows or rows[f"{prefix}success"].isna().all():
            continue
        success = rows[f"{prefix}success"].astype(float)
        result[f"{prefix}success"] = float(success.mean())
        result[f"{prefix}success_interval"] = _interval(rows, success)
        right = rows[success == 1.0]
        for column in ("delay_s", "delay_clipped_s", "margin_s"):
            result[f"{prefix}{column}"] = _mean(right[f"{prefix}{column}"])
        result[f"{prefix}accuracy"] = {
            f"{f:.0%}": float(rows[f"{prefix}right_at_{f:.0%}"].astype(float).mean())
            for f in FRACTIONS
        }
        result[f"{prefix}accuracy_interval"] = {
            f"{f:.0%}": _interval(rows, rows[f"{prefix}right_at_{f:.0%}"].astype(float))
            for f in FRACTIONS
        }
    return result


def _by(rows: pd.DataFrame, column: str) -> dict[str, Any]:
    known = rows[rows[column].notna()]
    return {str(value): _short(part) for value, part in known.groupby(column, sort=True)}


def _short(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the few numbers that are compared between conditions."""
    told = {"trials": len(rows), "success": _mean(rows["success"].astype(float))}
    if "grip_success" in rows and rows["grip_success"].notna().any():
        told["grip_success"] = _mean(rows["grip_success"].astype(float))
    for f in (0.4, 0.6):
        told[f"accuracy_{f:.0%}"] = _mean(rows[f"right_at_{f:.0%}"].astype(float))
    return told


def _binned(rows: pd.DataFrame, column: str, edges: Sequence[float]) -> dict[str, Any]:
    if column not in rows or not len(rows):
        return {}
    told = {}
    values = pd.to_numeric(rows[column], errors="coerce")
    for low, high in pairwise(edges):
        part = rows[(values >= low) & (values < high)]
        if len(part):
            told[f"{low:g} to {high:g}"] = _short(part)
    return told


def _over_participants(rows: pd.DataFrame) -> dict[str, Any]:
    """Return mean and sd over the participants' own means, as the paper gives them."""
    told: dict[str, Any] = {}
    for column in ("success", "grip_success"):
        if column not in rows or rows[column].isna().all() or not len(rows):
            continue
        means = rows[column].astype(float).groupby(rows["participant"]).mean()
        sd = float(means.std(ddof=1)) if len(means) > 1 else None
        told[column] = {"mean": float(means.mean()), "sd": sd, "participants": len(means)}
    return told


def _no_reach(rows: pd.DataFrame) -> dict[str, Any]:
    if not len(rows) or "named" not in rows:
        return {}
    told: dict[str, Any] = {
        "minutes": float(rows["seconds"].sum()) / 60.0,
        "answers": int(rows["answers"].sum()),
        "target_named": _part(rows["named"].sum(), rows["answers"].sum()),
        "target_named_while_moving": _part(rows["named_reaching"].sum(), rows["reaching"].sum()),
    }
    if rows["with_probability"].sum():
        told["none_most_probable"] = _part(
            rows["none_most_probable"].sum(), rows["with_probability"].sum()
        )
    return told


def _commitment(reaches: pd.DataFrame, none: pd.DataFrame) -> dict[str, Any]:
    """Return the curve over all reaches, over the valid ones, and over each group of them."""
    valid = reaches[reaches["valid"] == True]  # noqa: E712
    told = {"all": commitments.sum_up(reaches, none), "valid": commitments.sum_up(valid, none)}
    groups = reaches[reaches["group"].notna()].groupby("group", sort=True)
    return told | {f"group {g}": commitments.sum_up(rows, none) for g, rows in groups}


def _calibration(rows: pd.DataFrame) -> dict[str, Any] | None:
    """Return the pooled calibration error and Brier score; None without probabilities."""
    if "calibration_n" not in rows or rows["calibration_n"].isna().all():
        return None
    known = rows[rows["calibration_n"].notna()]
    n, stated, right = (
        np.sum(np.stack([np.asarray(v, dtype=float) for v in known[f"calibration_{what}"]]), axis=0)
        for what in ("n", "stated", "right")
    )
    return {
        "ece": float(np.abs(stated - right).sum() / n.sum()),
        "brier": float(known["brier_sum"].sum() / known["brier_n"].sum()),
        "answers": int(n.sum()),
        "bins": [
            {"stated": stated[b] / n[b], "right": right[b] / n[b], "answers": int(n[b])}
            for b in range(BINS) if n[b]
        ],
    }  # fmt: skip


def _interval(rows: pd.DataFrame, values: pd.Series) -> list[float] | None:
    groups = rows["participant"].astype("category").cat.codes.to_numpy().astype(np.int64)
    if len(np.unique(groups)) < MIN_PEOPLE:
        return None
    low, high = interval_over_groups(values.to_numpy(float), groups)
    return None if np.isnan(low) else [low, high]


def _mean(values: pd.Series | None) -> float | None:
    if values is None:
        return None
    known = pd.to_numeric(values, errors="coerce").dropna()
    return float(known.mean()) if len(known) else None


def _part(some: float, of: float) -> float | None:
    return float(some) / float(of) if of else None


def _count(rows: pd.DataFrame, column: str) -> dict[str, int]:
    if column not in rows:
        return {}
    return {str(k): int(v) for k, v in rows[column].dropna().value_counts().items()}
