"""The benchmark's table: a row for each entry and set, each number with its interval."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from igrip.lab.evaluation.calibration import ReliabilityBins, interval_over_groups

EARLY = ("right_at_30%", "right_at_40%", "right_at_50%", "right_at_60%")
MIN_PEOPLE = 2  # for an interval
DRAWS = 1000
Number = dict[str, float | None]


def frame_of(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Return rows as a table with all columns."""
    frame = pd.DataFrame(list(rows))
    needed = (
        "problem", "success", *EARLY, "committed", "lease_right", "lease_part", "false_leases",
        "ms", "calibration_n", "calibration_stated", "calibration_right", "reach", "seconds",
    )  # fmt: skip
    for name in needed:
        if name not in frame:
            frame[name] = None
    return frame


def sum_up(frame: pd.DataFrame) -> list[dict[str, Any]]:
    """Return a row of numbers for each set and entry, in the order of the frame.

    Each number is a mapping of ``value``, ``low`` and ``high``: 95 % intervals over participants,
    by bootstrap; None with one participant alone, or where there is nothing to count.
    """
    found = []
    for (set_name, entry), part in frame.groupby(["set", "entry"], sort=False):
        good = part[part["problem"].isna()]
        reaches = good[good["reach"].astype(bool)]
        still = good[~good["reach"].astype(bool)]
        found.append({
            "set": set_name, "entry": entry, "reaches": len(reaches),
            "people": int(good["participant"].nunique()),
            "excluded": int(part["problem"].notna().sum()),
            "success": _mean(reaches, "success"),
            "early": _mean(reaches.assign(early=_early(reaches)), "early"),
            "right_at_40%": _mean(reaches, "right_at_40%"),
            "right_at_60%": _mean(reaches, "right_at_60%"),
            "ece": _over_people(reaches, _calibration_error),
            "committed": _mean(reaches, "committed"),
            "lease_right": _mean(reaches, "lease_right"),
            "lease_part": _mean(reaches, "lease_part"),
            "false_per_minute": _over_people(still, _false_per_minute),
            "ms": _median(good, "ms"),
        })  # fmt: skip
    return found


def _early(reaches: pd.DataFrame) -> pd.Series:
    return reaches[list(EARLY)].astype(float).mean(axis=1)


def _mean(part: pd.DataFrame, column: str) -> Number:
    values = pd.to_numeric(part[column], errors="coerce").astype(float)
    known = values.notna()
    if not known.any():
        return {"value": None, "low": None, "high": None}
    low, high = interval_over_groups(values, part["participant"], draws=DRAWS)
    return _number(float(values[known].mean()), low, high)


def _median(part: pd.DataFrame, column: str) -> Number:
    values = pd.to_numeric(part[column], errors="coerce").dropna()
    if values.empty:
        return {"value": None, "low": None, "high": None}
    low, high = (float(values.quantile(q)) for q in (0.05, 0.95))
    return _number(float(values.median()), low, high)


def _over_people(part: pd.DataFrame, measure: Callable[[pd.DataFrame], float]) -> Number:
    """Return a measure over all rows, with a bootstrap interval over participants."""
    value = measure(part)
    groups = [rows for _, rows in part.groupby("participant")]
    if not np.isfinite(value) or len(groups) < MIN_PEOPLE:
        return _number(value, float("nan"), float("nan"))
    random = np.random.default_rng(0)
    drawn = [
        measure(pd.concat([groups[k] for k in random.integers(0, len(groups), len(groups))]))
        for _ in range(DRAWS)
    ]
    low, high = np.nanquantile(drawn, (0.025, 0.975))
    return _number(value, float(low), float(high))


def _calibration_error(reaches: pd.DataFrame) -> float:
    known = reaches[reaches["calibration_n"].notna()]
    if known.empty:
        return float("nan")
    sums = [np.sum(known[f"calibration_{name}"].tolist(), axis=0) for name in
            ("n", "stated", "right")]  # fmt: skip
    return ReliabilityBins(*sums).calibration_error()


def _false_per_minute(still: pd.DataFrame) -> float:
    minutes = float(still["seconds"].sum()) / 60.0
    return float(still["false_leases"].sum()) / minutes if minutes else float("nan")


def _number(value: float, low: float, high: float) -> Number:
    return {
        key: x if np.isfinite(x) else None
        for key, x in (("value", value), ("low", low), ("high", high))
    }


COLUMNS = (
    ("set", None), ("entry", None), ("reaches", None), ("people", None),
    ("trials right", "success"), ("right at 40 %", "right_at_40%"),
    ("right at 60 %", "right_at_60%"), ("30–60 %", "early"), ("ECE", "ece"),
    ("committed", "committed"), ("right", "lease_right"), ("at part", "lease_part"),
    ("false a minute", "false_per_minute"), ("ms a message", "ms"),
)  # fmt: skip
PLAIN = {"ece": "{:.3f}", "false_per_minute": "{:.2f}", "ms": "{:.2f}"}


def lines_of(table: Sequence[dict[str, Any]]) -> Iterator[list[str]]:
    """Yield the header and the rows of the table as texts."""
    yield [head for head, _ in COLUMNS]
    for row in table:
        yield [str(row[head]) if key is None else _text(key, row[key]) for head, key in COLUMNS]


def markdown(table: Sequence[dict[str, Any]]) -> str:
    """Return the table as Markdown."""
    head, *rows = lines_of(table)
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"


def _text(key: str, number: Number) -> str:
    value, low, high = number["value"], number["low"], number["high"]
    if value is None:
        return "–"
    if key in PLAIN:
        form = PLAIN[key].format
        return form(value) if low is None or high is None else (
            f"{form(value)} [{form(low)}–{form(high)}]"
        )  # fmt: skip
    if low is None or high is None:
        return f"{100 * value:.1f}"
    return f"{100 * value:.1f} [{100 * low:.0f}–{100 * high:.0f}]"
