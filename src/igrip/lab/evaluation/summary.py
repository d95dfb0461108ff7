"""The rows of an evaluation summed up: the paper's table, and what it leaves out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd

from igrip.lab.evaluation.averages import TIMES, average_scores, mean, numbers
from igrip.lab.evaluation.calibration import ReliabilityBins, interval_over_groups
from igrip.lab.evaluation.commitments import at, configured_reliability, summarise_commitments
from igrip.lab.evaluation.predicted_times import summarise_times
from igrip.lab.evaluation.trial_description import NO_REACH

CONDITIONS = ("view", "movement", "grip", "hand", "target", "group", "participant")
COLUMNS = (
    "recording", "participant", "targets", "target", "problem", "remark", "valid", "group", "view",
    "movement", "grip", "hand", "success", "seconds", "messages", "observed", "objects",
    "both_seen_0.3s_before_end", "bounds", "invalid_reason", "movement_s",
)  # fmt: skip
MIN_PEOPLE = 5  # below it an interval over participants is meaningless
ANGLES = (0.0, 10.0, 20.0, 40.0, 180.0)  # edges of the bins of the angular gap [deg]
DEPTHS = (-np.inf, -0.1, 0.0, 0.1, np.inf)  # of the depth gap [m]


def frame_of(rows: Iterable[dict[str, Any]]) -> pd.DataFrame:
    """Return rows as a table, with None where a row lacks a column that others have."""
    columns: dict[str, list[Any]] = {}
    for k, row in enumerate(rows):  # column by column: a dict for each row takes five times more
        for name, value in row.items():
            values = columns.setdefault(name, [])
            values += [None] * (k - len(values))
            values.append(value)
    height = max(map(len, columns.values()), default=0)
    frame = pd.DataFrame({n: v + [None] * (height - len(v)) for n, v in columns.items()})
    for column in COLUMNS:
        if column not in frame:
            frame[column] = None
    frame["participant"] = frame["participant"].fillna("unknown")
    return frame


def summarise(frame: pd.DataFrame, name: str, targets: Sequence[str]) -> dict[str, Any]:
    """Sum up an evaluation; the keys are documented in ``docs/evaluation.md``.

    ``frame`` is that of :func:`frame_of`, ``name`` the dataset's, and ``targets`` are the
    estimators in the order of the report.
    """
    one = frame[frame["targets"] == targets[0]]  # for what does not depend on the estimator
    broken = one[one["problem"].notna()]
    reaches, none = reaches_of(one), _without_reach(one)
    valid = valid_of(reaches)
    return {
        "schema": "igrip-summary/1",
        "dataset": name,
        "recordings": len(one),
        "excluded": broken[["recording", "participant", "problem"]].to_dict("records"),
        "remarks": one[one["remark"].notna()][["recording", "remark"]].to_dict("records"),
        "reaches": len(reaches),
        "valid": len(valid),
        "valid_share": _share(len(valid), len(reaches)),
        "invalid_reasons": reaches["invalid_reason"].value_counts().to_dict(),
        "observed_share": _share(
            (reaches["observed"] * reaches["messages"]).sum(), reaches["messages"].sum()
        ),
        "bounds_from_trace": int((reaches["bounds"] == "trace").sum()),
        "movement_s": mean(reaches["movement_s"]),
        "no_reach_minutes": _minutes(none),
        "targets": {target: _estimator(frame[frame["targets"] == target]) for target in targets},
    }


def reaches_of(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the reaches that could be scored."""
    return rows[(rows["target"] != NO_REACH) & rows["problem"].isna()]


def valid_of(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the valid trials."""
    return rows[rows["valid"].eq(True)]


def _without_reach(rows: pd.DataFrame) -> pd.DataFrame:
    return rows[(rows["target"] == NO_REACH) & rows["problem"].isna()]


def _estimator(rows: pd.DataFrame) -> dict[str, Any]:
    reaches, none = reaches_of(rows), _without_reach(rows)
    valid = valid_of(reaches)
    groups = reaches[reaches["group"].notna()].groupby("group")
    sets = {"all": reaches, "valid": valid, **{f"group {name}": part for name, part in groups}}
    reliability = configured_reliability(rows)
    commitment = {
        name: summarise_commitments(part, none, reliability) for name, part in sets.items()
    }
    return {
        "valid": scores(valid),
        "all": scores(reaches),
        "seen_in_time": scores(reaches[reaches["both_seen_0.3s_before_end"].eq(True)]),
        "by": {c: _by(valid, c) for c in CONDITIONS if valid[c].notna().any()},
        "by_objects": _by(valid, "objects"),
        "by_angular_gap_deg": _binned(valid, "angular_gap_deg", ANGLES),
        "by_depth_gap_m": _binned(valid, "depth_gap_m", DEPTHS),
        "participants": _over_participants(valid),
        "no_reach": _no_reach(none),
        "calibration": _calibration(reaches),
        "times": {name: summarise_times(part) for name, part in sets.items()},
        "commitment": commitment,
        "first_commitments": {name: at(reliability, curve) for name, curve in commitment.items()},
    }


def scores(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the paper's numbers and causal accuracy over some trials, with intervals."""
    result: dict[str, Any] = {"trials": len(rows)} | dict.fromkeys(
        ("frames", "success", "success_interval", *TIMES)
    )
    if not len(rows) or "frames_possible" not in rows:
        return result
    result["frames"] = _share(rows["frames_right"].sum(), rows["frames_possible"].sum())
    if "grip_frames_right" in rows:
        graded = rows[rows["grip_frames_right"].notna()]
        result["grip_frames"] = _share(
            graded["grip_frames_right"].sum(), graded["frames_possible"].sum()
        )
    for prefix in ("", "grip_"):
        if f"{prefix}success" not in rows or rows[f"{prefix}success"].isna().all():
            continue
        averages = average_scores(rows, prefix)
        accuracy = averages.pop("accuracy")
        result |= {f"{prefix}{key}": value for key, value in averages.items()}
        result[f"{prefix}success_interval"] = _interval(rows, f"{prefix}success")
        result[f"{prefix}accuracy"] = accuracy
        result[f"{prefix}accuracy_interval"] = {
            part: _interval(rows, f"{prefix}right_at_{part}") for part in accuracy
        }
    return result


def _by(rows: pd.DataFrame, column: str) -> dict[str, Any]:
    known = rows[rows[column].notna()]
    return {str(value): _short(part) for value, part in known.groupby(column)}


def _short(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the few numbers that are compared between conditions."""
    averages = average_scores(rows)
    short = {"trials": len(rows), "success": averages["success"]}
    if "grip_success" in rows and rows["grip_success"].notna().any():
        short["grip_success"] = mean(rows["grip_success"])
    return short | {f"accuracy_{part}": averages["accuracy"][part] for part in ("40%", "60%")}


def _binned(rows: pd.DataFrame, column: str, edges: Sequence[float]) -> dict[str, Any]:
    if column not in rows:
        return {}
    values = numbers(rows[column])
    bins = {
        f"{low:g} to {high:g}": rows[(values >= low) & (values < high)]
        for low, high in pairwise(edges)
    }
    return {name: _short(part) for name, part in bins.items() if len(part)}


def _over_participants(rows: pd.DataFrame) -> dict[str, Any]:
    """Return mean and sd over the participants' own means, as the paper gives them."""
    result: dict[str, Any] = {}
    for column in ("success", "grip_success"):
        if column not in rows or rows[column].isna().all():
            continue
        means = rows[column].astype(float).groupby(rows["participant"]).mean()
        sd = float(means.std(ddof=1)) if len(means) > 1 else None
        result[column] = {"mean": float(means.mean()), "sd": sd, "participants": len(means)}
    return result


def _no_reach(rows: pd.DataFrame) -> dict[str, Any]:
    if not len(rows) or "named" not in rows:
        return {}
    total = rows[
        ["answers", "named", "reaching", "named_reaching", "with_probability", "none_most_probable"]
    ].sum()
    result: dict[str, Any] = {
        "minutes": _minutes(rows),
        "answers": int(total["answers"]),
        "target_named": _share(total["named"], total["answers"]),
        "target_named_while_moving": _share(total["named_reaching"], total["reaching"]),
    }
    if total["with_probability"]:
        result["none_most_probable"] = _share(
            total["none_most_probable"], total["with_probability"]
        )
    return result


def _calibration(rows: pd.DataFrame) -> dict[str, Any] | None:
    """Return the pooled calibration error and Brier score; None without probabilities."""
    if "calibration_n" not in rows or rows["calibration_n"].isna().all():
        return None
    known = rows[rows["calibration_n"].notna()]
    bins = ReliabilityBins(
        *(np.sum(np.stack(list(known[f"calibration_{sums}"])), axis=0)
          for sums in ("n", "stated", "right"))
    )  # fmt: skip
    return {
        "ece": bins.calibration_error(),
        "brier": float(known["brier_sum"].sum() / known["brier_n"].sum()),
        "answers": int(bins.answers.sum()),
        "bins": [
            {"stated": stated / n, "right": correct / n, "answers": int(n)}
            for n, stated, correct in zip(*bins, strict=True) if n
        ],
    }  # fmt: skip


def _interval(rows: pd.DataFrame, column: str) -> list[float] | None:
    if rows["participant"].nunique() < MIN_PEOPLE:
        return None
    return list(interval_over_groups(rows[column], rows["participant"]))


def _minutes(rows: pd.DataFrame) -> float:
    return float(rows["seconds"].sum()) / 60.0


def _share(part: float, whole: float) -> float | None:
    return float(part) / float(whole) if whole else None
