"""Fit of the probability of a pinch: logistic regression, convex, so there is one optimum."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression

from igrip.grips.contact import FORMAT, INPUTS, TERMS, approaches
from training.moments import Frames, Recording

Array = NDArray[np.float64]
DIGITS = 6
RIDGE = 1.0


def approaches_of(recording: Recording, frames: Frames) -> Array:
    """Return rows of inputs, whether it is a pinch, and weight, from onset to when it is left."""
    rows = []
    for motion, geometry in frames:
        ids = [placed.id for placed in geometry.objects]
        wanted = recording.onset <= motion.t <= min(recording.back, recording.end + 0.2)
        if recording.target not in ids or not wanted:
            continue
        cylinders, target = geometry.cylinders(), ids.index(str(recording.target))
        if abs(cylinders.axis[target, 2]) < 0.9:  # it lies: simulated grasps know only upright ones
            return np.empty((0, len(INPUTS) + 2))
        own = approaches(motion.position, motion.velocity, cylinders)[target]
        rows.append([*np.round(own, DIGITS), recording.grip == "pinch", 30.0 / recording.rate])
    return np.array(rows, dtype=np.float64).reshape(-1, len(INPUTS) + 2)


def terms_of(inputs: Array) -> Array:
    """Return the terms of the polynomial, shape (n, t)."""
    i, j = np.triu_indices(inputs.shape[1])
    return np.column_stack([np.ones(len(inputs)), inputs, inputs[:, i] * inputs[:, j]])


def fit_grip(approaches: Sequence[Array]) -> dict[str, float]:
    """Return the weights of the terms, with a small ridge."""
    rows = np.concatenate(approaches)
    terms, pinch, weight = terms_of(rows[:, :-2]), rows[:, -2], rows[:, -1]
    model = LogisticRegression(
        C=1.0 / RIDGE, fit_intercept=False, solver="newton-cholesky", tol=1e-10, max_iter=100
    )
    weights = model.fit(terms, pinch > 0.5, sample_weight=weight).coef_[0]
    return dict(zip(TERMS, np.round(weights, DIGITS).tolist(), strict=True))


def write_grip(weights: dict[str, float], provenance: dict[str, Any], path: Path) -> None:
    """Write the weights, a line for each."""
    content = {"format": FORMAT, "provenance": provenance, "weights": weights}
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
