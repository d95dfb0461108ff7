"""Noise of sampled positions, estimated by third differences, which are zero for a parabola."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

Array = NDArray[np.float64]

# layout of the state, used in this file alone: number of samples, variance, and the last three
# samples as rows t, x, y, z
COUNT, VARIANCE, ROWS, SIZE = 0, 1, 2, 14
PRIOR_SAMPLES = 4.0  # weight of the initial variance, in samples; guess
MAX_RATIO = 9.0  # a sample counts at most this many times the variance: an outlier, or a jerk


def new_noise(variance: float) -> Array:
    """Return the state of an estimate before its first sample; ``variance`` is a guess [m²]."""
    state = np.zeros(SIZE)
    state[VARIANCE] = variance
    return state


@kernel
def reset_noise(state, variance):
    """Forget all samples; ``variance`` is the new first guess [m²]."""
    state[:] = 0.0
    state[VARIANCE] = variance


@kernel
def variance_of(state):
    """Return the estimated variance of each coordinate [m²]."""
    return state[VARIANCE]


@kernel
def update_noise(state, t, x, y, z, time_constant):
    """Add a sample and estimate the variance of each coordinate.

    The third divided difference of four samples is zero for any parabola, however the times are
    spaced; for white noise its variance is known.

    Parameters
    ----------
    state : (14,), changed
        Of :func:`new_noise`.
    t, x, y, z : float
        The sample [s, m].
    time_constant : float
        Memory of the estimate [s].
    """
    rows = state[ROWS:].reshape(3, 4)
    if state[COUNT] >= 3.0:
        part = np.empty(4)
        gain = 0.0
        for i in range(4):
            own, product = (rows[i, 0] if i < 3 else t), 1.0
            for j in range(4):
                if j != i:
                    product *= (own - (rows[j, 0] if j < 3 else t)) / (t - rows[0, 0])
            part[i] = 1.0 / product
            gain += part[i] ** 2
        sum2 = 0.0
        for axis in range(3):
            newest = x if axis == 0 else y if axis == 1 else z
            difference = part[3] * newest
            for i in range(3):
                difference += part[i] * rows[i, 1 + axis]
            sum2 += difference**2
        weight = max(
            1.0 / (state[COUNT] - 2.0 + PRIOR_SAMPLES),
            1.0 - math.exp(-(t - rows[2, 0]) / time_constant),
        )
        measured = min(sum2 / (3.0 * gain), MAX_RATIO * state[VARIANCE])
        state[VARIANCE] += weight * (measured - state[VARIANCE])
    state[COUNT] += 1.0
    for i in range(2):
        rows[i] = rows[i + 1]
    rows[2, 0], rows[2, 1], rows[2, 2], rows[2, 3] = t, x, y, z
