"""Conditional logit (McFadden 1974): what the network is compared with. Convex, fitted by scipy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from igrip.targets.learned.features import LOCAL
from igrip.targets.learned.network import MAX_INPUT
from training.moments import Moments, selected

Array = NDArray[np.float64]
Terms = Callable[[Array], Array]
RIDGE = 1.0
EVERY = 3  # every third frame: enough for a few thousand weights
CHUNK = 60000  # rows whose terms are in memory at a time


def quadratic(inputs: Array) -> Array:
    """Return a constant, the inputs, and products of what is relative to rivals or of the movement.

    The products of all inputs would be three thousand weights.
    """
    relative = inputs[:, len(LOCAL) :]
    i, j = np.triu_indices(relative.shape[1])
    return np.column_stack([np.ones(len(inputs)), inputs, relative[:, i] * relative[:, j]])


def linear(inputs: Array) -> Array:
    """Return a constant and the inputs."""
    return np.column_stack([np.ones(len(inputs)), inputs])


def fit_logit(inputs: Array, moments: Moments, terms: Terms = linear) -> Array:
    """Return the weights that maximise the likelihood, with a small ridge.

    Parameters
    ----------
    inputs : (r, i)
        Standardised, a row for each row of the moments.
    moments : Moments
        Frames with the target's row, or -1 for none.
    terms : function
        From inputs to the terms of the polynomial.
    """
    keep = np.arange(len(moments.target)) % EVERY == 0
    rows, moments = inputs[keep[moments.frame]], selected(moments, keep)
    weight, hit = moments.weight, moments.target[moments.target >= 0]
    hit_weight = weight[moments.target >= 0]

    def loss(weights: Array) -> tuple[float, Array]:
        scores = _scores(rows, weights, terms)
        likelihood = np.exp(np.clip(scores, -50.0, 50.0))
        total = 1.0 + np.bincount(moments.frame, likelihood, len(weight))
        off = weight[moments.frame] * likelihood / total[moments.frame]
        np.subtract.at(off, hit, hit_weight)
        value = weight @ np.log(total) - hit_weight @ scores[hit]
        gradient = RIDGE * weights
        for begin in range(0, len(rows), CHUNK):
            gradient = gradient + off[begin : begin + CHUNK] @ terms(rows[begin : begin + CHUNK])
        return value + 0.5 * RIDGE * float(weights @ weights), gradient

    size = terms(inputs[:1]).shape[1]
    options: Any = {"maxiter": 2000, "maxfun": 4000, "ftol": 1e-12, "gtol": 1e-6}
    fitted = minimize(loss, np.zeros(size), jac=True, method="L-BFGS-B", options=options)
    weights: Array = fitted.x
    return weights


def _scores(rows: Array, weights: Array, terms: Terms) -> Array:
    parts = [terms(rows[k : k + CHUNK]) @ weights for k in range(0, len(rows), CHUNK)]
    return np.concatenate(parts)


def logit_scores(
    inputs: Array, mean: Array, scale: Array, weights: Array, terms: Terms = linear
) -> Array:
    """Return the log-odds of each row."""
    return _scores(np.clip((inputs - mean) / scale, -MAX_INPUT, MAX_INPUT), weights, terms)
