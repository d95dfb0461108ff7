"""A movement as seen from a body that moves itself: an approach to it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.motion.reach_kernel import ReachState, set_reach, start_of, times_of

Array = NDArray[np.float64]
MAX_AHEAD = 0.25  # s; where a body is now is extrapolated from its last pose by at most this
SPAN = 0.09  # s; speeds are those over this time: single steps are mostly noise


@kernel
def _place(path, t, out):
    """Write where the body was at a time: between two rows of its path, or at its ends."""
    last = path.shape[0] - 1
    k = 0
    while k < last and path[k + 1, 0] < t:
        k += 1
    after = min(k + 1, last)
    span = path[after, 0] - path[k, 0]
    part = 0.0 if span <= 0.0 else min(max((t - path[k, 0]) / span, 0.0), 1.0)
    for axis in range(3):
        out[axis] = (1.0 - part) * path[k, 1 + axis] + part * path[after, 1 + axis]


@kernel
def _approach(state, points, path, ahead):
    """Move points and start to where they were from the body as it is now, in place."""
    t, onset, _ = times_of(state)
    now, then = path[-1, 1:] + ahead, np.empty(3)
    _place(path, onset, then)
    start = start_of(state)
    for axis in range(3):
        start[axis] += now[axis] - then[axis]
    for k in range(points.shape[0]):
        _place(path, points[k, 0], then)
        for axis in range(3):
            points[k, 1 + axis] += now[axis] - then[axis]
    peak, peak_t, length, before = 0.0, t, 0.0, 0
    for k in range(1, points.shape[0]):
        if points[k, 0] - points[before, 0] < SPAN and k < points.shape[0] - 1:
            continue
        step2 = 0.0
        for axis in range(3):
            step2 += (points[k, 1 + axis] - points[before, 1 + axis]) ** 2
        step, lasted = math.sqrt(step2), max(points[k, 0] - points[before, 0], 1e-3)
        length += step
        if lasted >= 0.5 * SPAN and step / lasted > peak:
            peak, peak_t = step / lasted, points[k, 0]
        before = k
    set_reach(state, peak, peak_t, length)


def approach_of(reach: ReachState, path: Array, velocity: Array) -> tuple[ReachState, Array]:
    """Return a movement as seen from a body, in the world frame with the body where it is now.

    Parameters
    ----------
    reach : ReachState
        Of a hand that moves or may have begun to.
    path : (n, 4)
        Rows t, x, y, z of the body [s, m].
    velocity : (3,)
        Of the body, now [m/s].

    Returns
    -------
    seen : ReachState
        The approach.
    ahead : (3,)
        How far the body is from its last row by now, by its velocity [m].
    """
    late = min(max(float(times_of(reach.state)[0]) - path[-1, 0], 0.0), MAX_AHEAD)
    ahead = late * velocity
    state, points, now = reach.state.copy(), reach.points.copy(), reach.now.copy()
    _approach(state, points, path, ahead)
    now[1] -= velocity
    return ReachState(reach.moving, state, points, now), ahead
