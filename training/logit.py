"""Conditional logit (McFadden 1974): what the network is compared with. Convex; Newton's method."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from igrip.targets.learned.features import LOCAL
from igrip.targets.learned.network import BOUND
from training.moments import Moments

Array = NDArray[np.float64]
Terms = Callable[[Array], Array]
RIDGE = 1.0
PART = 3  # every so manyth frame: enough for a few thousand weights
CHUNK = 20000


def quadratic(inputs: Array) -> Array:
    """Return the inputs, and all products of what an object has beyond its rivals and the movement.

    The products of everything would be three thousand weights.
    """
    apart = inputs[:, len(LOCAL) :]
    i, j = np.triu_indices(apart.shape[1])
    return np.column_stack([np.ones(len(inputs)), inputs, apart[:, i] * apart[:, j]])


def linear(inputs: Array) -> Array:
    """Return the inputs and a constant."""
    return np.column_stack([np.ones(len(inputs)), inputs])


def fit_logit(inputs: Array, moments: Moments, terms: Terms = linear) -> Array:
    """Return the weights that maximise the likelihood, with a small ridge."""
    size = terms(inputs[:1]).shape[1]
    frames = len(moments.target)
    edges = np.append(np.flatnonzero(np.diff(moments.frame, prepend=-1)), len(moments.frame))
    chosen = np.arange(0, frames, PART)
    weights = np.zeros(size)
    for _ in range(15):
        gradient, curvature = RIDGE * weights, RIDGE * np.eye(size)
        for begin in range(0, len(chosen), CHUNK):
            part = chosen[begin : begin + CHUNK]
            counts = edges[part + 1] - edges[part]
            rows = np.concatenate([np.arange(edges[f], edges[f + 1]) for f in part])
            frame = np.repeat(np.arange(len(part)), counts)
            x = terms(inputs[rows])
            likely = np.exp(np.clip(x @ weights, -50.0, 50.0))
            share = likely / (1.0 + np.bincount(frame, weights=likely))[frame]
            weight = moments.weight[part][frame]
            hit = moments.target[part]
            hit = hit[hit >= 0]
            off = weight * share
            off[np.searchsorted(rows, hit)] -= moments.weight[part][moments.target[part] >= 0]
            gradient += x.T @ off
            first = np.cumsum(counts) - counts
            mean = np.add.reduceat(x * share[:, None], first, axis=0)
            curvature += (x * (weight * share)[:, None]).T @ x
            curvature -= (mean * moments.weight[part][:, None]).T @ mean
        step = np.linalg.solve(curvature, gradient)
        weights = weights - step * min(1.0, 4.0 / np.abs(x @ step).max())
        if np.abs(step).max() < 1e-6:
            break
    return weights


def logit_scores(
    inputs: Array, mean: Array, scale: Array, weights: Array, terms: Terms = linear
) -> Array:
    """Return the log-odds of each row."""
    x = np.clip((inputs - mean) / scale, -BOUND, BOUND)
    parts = [terms(x[k : k + CHUNK]) @ weights for k in range(0, len(x), CHUNK)]
    return np.concatenate(parts)
