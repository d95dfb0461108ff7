"""Position, velocity and acceleration by discounted least squares, at any sampling rate.

A parabola is fitted to all samples with weights that fall by ``exp(-age / time_constant)``
(Morrison 1969, Introduction to Sequential Smoothing and Prediction: fading memory). Only five
moments of the times and nine of the positions are kept, so a step costs the same at 15 and at
120 Hz, and the memory is a time, not a number of samples.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

Array = NDArray[np.float64]

# layout of the state, used in this file alone: time of the newest sample, moments of the times,
# of times × positions, newest position
TIME, MOMENTS, SUMS, NEWEST, SIZE = 0, 1, 6, 15, 18
# A hand is likelier slow and straight than not: weights of zero velocity and zero acceleration, as
# parts of a sample, that keep the first few samples of a trace tame (guesses).
VELOCITY_PRIOR, ACCELERATION_PRIOR = 0.03, 0.5


def new_fit() -> tuple[Array, Array]:
    """Return state and result of a fit before its first sample: zeros, (18,) and (3, 3)."""
    return np.zeros(SIZE), np.zeros((3, 3))


@kernel
def update_fit(state, t, x, y, z, time_constant, out):
    """Add a sample at ``t`` [s], later than the last, and fit.

    Parameters
    ----------
    state : (18,), changed
        Zeros before the first sample.
    t, x, y, z : float
        The sample [s, m].
    time_constant : float
        Age at which the weight of a sample has fallen to 1 / e [s].
    out : (3, 3), written
        Rows position, velocity and acceleration at ``t`` [m, m/s, m/s²].
    """
    if state[MOMENTS] > 0.0:
        # times are counted from the newest sample in units of the time constant: move their origin
        d = (state[TIME] - t) / time_constant
        fade = math.exp(d)
        m0, m1, m2, m3, m4 = state[1], state[2], state[3], state[4], state[5]
        state[1] = fade * m0
        state[2] = fade * (m1 + d * m0)
        state[3] = fade * (m2 + d * (2.0 * m1 + d * m0))
        state[4] = fade * (m3 + d * (3.0 * m2 + d * (3.0 * m1 + d * m0)))
        state[5] = fade * (m4 + d * (4.0 * m3 + d * (6.0 * m2 + d * (4.0 * m1 + d * m0))))
        for axis in range(3):
            b0, b1, b2 = state[SUMS + axis], state[SUMS + 3 + axis], state[SUMS + 6 + axis]
            state[SUMS + axis] = fade * b0
            state[SUMS + 3 + axis] = fade * (b1 + d * b0)
            state[SUMS + 6 + axis] = fade * (b2 + d * (2.0 * b1 + d * b0))
            # positions are counted from the newest: a far-off origin costs no digits
            moved = (x if axis == 0 else y if axis == 1 else z) - state[NEWEST + axis]
            for power in range(3):
                state[SUMS + 3 * power + axis] -= moved * state[MOMENTS + power]
    state[TIME] = t
    state[NEWEST], state[NEWEST + 1], state[NEWEST + 2] = x, y, z
    state[MOMENTS] += 1.0
    m0, m1, m3 = state[1], state[2], state[4]
    m2, v2, m4 = state[3], state[3] + VELOCITY_PRIOR, state[5] + ACCELERATION_PRIOR
    c00, c01, c02 = v2 * m4 - m3 * m3, m2 * m3 - m1 * m4, m1 * m3 - m2 * v2
    c11, c12, c22 = m0 * m4 - m2 * m2, m1 * m2 - m0 * m3, m0 * v2 - m1 * m1
    determinant = m0 * c00 + m1 * c01 + m2 * c02
    for axis in range(3):
        b0, b1, b2 = state[SUMS + axis], state[SUMS + 3 + axis], state[SUMS + 6 + axis]
        offset = (c00 * b0 + c01 * b1 + c02 * b2) / determinant
        out[0, axis] = state[NEWEST + axis] + offset
        out[1, axis] = (c01 * b0 + c11 * b1 + c12 * b2) / determinant / time_constant
        curvature = (c02 * b0 + c12 * b1 + c22 * b2) / determinant
        out[2, axis] = 2.0 * curvature / (time_constant * time_constant)
