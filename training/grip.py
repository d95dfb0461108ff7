"""Fits the probability of a pinch: logistic regression, convex, so there is one answer."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.geometry import cylinder
from igrip.grips.contact import FORMAT, INPUTS, TERMS, approach_of
from training.moments import Frames, Recording

Array = NDArray[np.float64]
DIGITS = 6
RIDGE = 1.0
ITERATIONS = 50


def approaches_of(recording: Recording, frames: Frames) -> Array:
    """Return rows of inputs, whether it is a pinch, and weight, from onset to when it is left."""
    rows = []
    for motion, geometry in frames:
        ids = [placed.id for placed in geometry.objects]
        wanted = recording.onset <= motion.t <= min(recording.back, recording.end + 0.2)
        if recording.target not in ids or not wanted:
            continue
        cylinders, inputs = geometry.cylinders(), np.empty((len(ids), len(INPUTS)))
        if abs(cylinders[ids.index(str(recording.target)), cylinder.AXIS + 2]) < 0.9:
            return np.empty(
                (0, len(INPUTS) + 2)
            )  # it lies: the simulated grasps know no such thing
        approach_of(motion.position, motion.velocity, cylinders, inputs)
        own = inputs[ids.index(str(recording.target))]
        rows.append([*np.round(own, DIGITS), recording.grip == "pinch", 30.0 / recording.rate])
    return np.array(rows, dtype=np.float64).reshape(-1, len(INPUTS) + 2)


def terms_of(inputs: Array) -> Array:
    """Return the terms of the polynomial, shape (n, t)."""
    i, j = np.triu_indices(inputs.shape[1])
    return np.column_stack([np.ones(len(inputs)), inputs, inputs[:, i] * inputs[:, j]])


def fit_grip(approaches: Sequence[Array]) -> dict[str, float]:
    """Return the weights, by Newton's method with a small ridge."""
    rows = np.concatenate(approaches)
    terms, pinch, weight = terms_of(rows[:, :-2]), rows[:, -2], rows[:, -1]
    weights = np.zeros(terms.shape[1])
    for _ in range(ITERATIONS):
        likely = 1.0 / (1.0 + np.exp(-np.clip(terms @ weights, -50.0, 50.0)))
        gradient = terms.T @ (weight * (likely - pinch)) + RIDGE * weights
        curvature = (terms * (weight * likely * (1.0 - likely))[:, None]).T @ terms
        step = np.linalg.solve(curvature + RIDGE * np.eye(len(weights)), gradient)
        weights -= step
        if np.abs(step).max() < 1e-10:
            break
    return dict(zip(TERMS, np.round(weights, DIGITS).tolist(), strict=True))


def write_grip(weights: dict[str, float], provenance: dict[str, Any], path: Path) -> None:
    """Write the weights, a line for each."""
    told = {"format": FORMAT, "provenance": provenance, "weights": weights}
    path.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
