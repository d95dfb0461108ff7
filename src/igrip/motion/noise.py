"""How noisy are the samples of a position? By third differences, which no parabola changes."""

from __future__ import annotations

import math

import numpy as np

from igrip.compiled import kernel

# state: how many samples were taken, the variance, and the last three samples as rows t, x, y, z
COUNT, VARIANCE, ROWS, STATE = 0, 1, 2, 14
WORTH = 4.0  # samples that the noise believed at first is worth; guess
BOLDEST = 9.0  # a sample counts at most as so many times the variance: an outlier, or a jerk


@kernel
def watch(state, t, x, y, z, memory):
    """Take a sample and estimate the variance of each coordinate.

    The third divided difference of four samples is zero for any parabola, however the times are
    spaced; for white noise its variance is known.

    Parameters
    ----------
    state : (14,), changed
        ``COUNT`` zero and ``VARIANCE`` a first guess [m²] before the first sample.
    t, x, y, z : float
        The sample [s, m].
    memory : float
        Time constant of the estimate [s].
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
        weight = max(1.0 / (state[COUNT] - 2.0 + WORTH), 1.0 - math.exp(-(t - rows[2, 0]) / memory))
        seen = min(sum2 / (3.0 * gain), BOLDEST * state[VARIANCE])
        state[VARIANCE] += weight * (seen - state[VARIANCE])
    state[COUNT] += 1.0
    for i in range(2):
        rows[i] = rows[i + 1]
    rows[2, 0], rows[2, 1], rows[2, 2], rows[2, 3] = t, x, y, z
