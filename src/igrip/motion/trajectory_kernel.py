"""One sample of a trajectory, compiled: filter, slide the window, fit, follow, in one call.

A call from Python costs more than each of these steps.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.motion.one_euro_kernel import TIME, VALUE, step_position
from igrip.motion.quadratic_fit import predict

Array = NDArray[np.float64]

# columns of the window
T, POSITION, SPEED, WIDTH = 0, 1, 4, 5
# rows of the result, then as many predicted positions, then their velocities
FILTERED, COEFFICIENTS, FUTURE = 0, 1, 4


def new_window(samples: int) -> tuple[Array, NDArray[np.int64]]:
    """Return an empty window of at most so many samples, and where it begins and ends.

    It is twice as long, so that it can slide without moving on every sample.
    """
    return np.empty((2 * samples, WIDTH)), np.zeros(2, dtype=np.int64)


@kernel
def _append(window, ends, t, position, max_duration):
    """Add a sample that has no speed yet; samples that are too many or too old leave."""
    samples = len(window) // 2
    if ends[1] == len(window):
        kept = ends[1] - ends[0]
        for k in range(kept):
            window[k] = window[ends[0] + k]
        ends[0], ends[1] = 0, kept
    row = window[ends[1]]
    row[T], row[SPEED] = t, -1.0
    row[POSITION:SPEED] = position
    ends[1] += 1
    while ends[1] - ends[0] > samples or window[ends[0], T] < t - max_duration:
        ends[0] += 1


@kernel
def advance(filter_state, filter_parameters, window, ends, t, x, y, z, max_duration, steps, out):
    """Add a sample measured at ``t`` [s], later than the last, at ``x, y, z`` [m].

    Parameters
    ----------
    filter_state, filter_parameters : (11,), (3,)
        Of :mod:`igrip.motion.one_euro_kernel`; the state is changed.
    window, ends : (2 n, 5), (2,) int64, changed
        Of :func:`new_window`: rows time, filtered position, speed.
    max_duration : float
        Older samples leave the window [s].
    steps : (m,)
        Times from now on of the predicted points [s].
    out : (4 + 2 m, 3), written
        Filtered position; coefficients c0, c1, c2; predicted positions; their velocities.

    Returns
    -------
    speed, peak : float
        Of the polynomial, now, and the highest in the window before [m/s]; NaN where the window
        does not determine a polynomial, -1 where there was none before.
    """
    value = filter_state[VALUE : VALUE + 3]
    if ends[1] == 0:
        value[0], value[1], value[2] = x, y, z
        filter_state[TIME] = t
    else:
        step_position(filter_state, t, x, y, z, filter_parameters)
    _append(window, ends, t, value, max_duration)
    first, end, ahead = ends[0], ends[1], FUTURE + len(steps)
    out[FILTERED] = value
    speed = predict(
        window[first:end, T], window[first:end, POSITION:SPEED], steps,
        out[COEFFICIENTS:FUTURE], out[FUTURE:ahead], out[ahead:],
    )  # fmt: skip
    peak = -1.0
    for k in range(first, end - 1):
        peak = max(peak, window[k, SPEED])
    if not math.isnan(speed):
        window[end - 1, SPEED] = speed
    return speed, peak
