"""What real reaches look like, for the familiarity of a movement."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from igrip.targets.learned.familiarity import COLUMNS, FORMAT, USED, FamiliarMovements
from training.moments import Moments

QUANTILES = 201
RIDGE = 1e-4  # added to the variances
CLIPPED = 0.001  # share of outliers at each end that the covariance does not see
DIGITS = 6


def fit_familiarity(real: Moments) -> FamiliarMovements:
    """Return the description of the frames of real reaches in which one is under way."""
    values = real.shared[real.target >= 0][:, COLUMNS]
    centre = np.median(values, axis=0).round(DIGITS)
    low, high = np.quantile(values, [CLIPPED, 1.0 - CLIPPED], axis=0)
    covariance = np.cov(np.clip(values, low, high), rowvar=False)
    precision = np.linalg.inv(covariance + RIDGE * np.eye(len(centre))).round(DIGITS)
    off = values - centre
    distances = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", off, precision, off), 0.0))
    quantiles = np.quantile(distances, np.linspace(0.0, 1.0, QUANTILES)).round(DIGITS)
    return FamiliarMovements(centre, np.asarray(precision, dtype=np.float64), quantiles)


def write_familiarity(movements: FamiliarMovements, provenance: dict[str, Any], path: Path) -> None:
    """Write the description as text."""
    head = {"format": FORMAT, "provenance": provenance, "features": USED}
    rows = [
        f' "{name}": {json.dumps(value.tolist())}' for name, value in movements._asdict().items()
    ]
    path.write_text(
        f"{json.dumps(head, indent=1)[:-2]},\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8"
    )
