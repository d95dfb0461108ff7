"""Means over trials: the one way from rows to shares, delays and margins."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from igrip.lab.evaluation.trial_metrics import FRACTIONS

if TYPE_CHECKING:
    import pandas as pd

TIMES = ("delay_s", "delay_clipped_s", "margin_s")


def numbers(values: ArrayLike) -> NDArray[np.float64]:
    """Return a column as numbers: True is 1, False is 0, and what is unknown is NaN."""
    return np.asarray(values, dtype=np.float64)


def mean(values: ArrayLike) -> float | None:
    """Return the mean of what is known in a column; None where nothing is."""
    column = numbers(values)
    known = column[~np.isnan(column)]
    return float(known.mean()) if len(known) else None


def average_scores(rows: pd.DataFrame | Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return the paper's numbers and causal accuracy over some trials.

    ``rows`` are columns of :func:`igrip.lab.evaluation.trial_metrics.score_answers`; ``prefix`` is
    empty for the target, ``grip_`` for the grip. Times are means over the successful trials.
    """
    success = numbers(rows[f"{prefix}success"])
    accuracy = {f"{f:.0%}": mean(rows[f"{prefix}right_at_{f:.0%}"]) for f in FRACTIONS}
    times = {name: mean(numbers(rows[f"{prefix}{name}"])[success == 1.0]) for name in TIMES}
    return {"success": mean(success), **times, "accuracy": accuracy}
