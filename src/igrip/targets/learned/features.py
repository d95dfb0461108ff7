"""Features of a movement so far towards each object: ratios of lengths and of times.

They use the start of the movement, the hand, its velocity and acceleration, and an *aim* on each
object, the point of its axis nearest to where the hand will be in 0.12 s. They do not depend on the
order of the objects, on the frame, or on the unit of length.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.geometry.cylinder import Cylinders, axis_of, centre_of, size_of, velocity_of
from igrip.motion.approach import approach_of
from igrip.motion.reach_kernel import (
    ReachState,
    extent_of,
    noise_variance_of,
    start_of,
    times_of,
)

Array = NDArray[np.float64]
LOCAL = (
    "remaining", "log_remaining", "progress", "deviation", "heading_now", "heading_so_far",
    "speed_time", "peak_time", "miss_ahead", "miss_now", "remaining_to_surface", "object_speed",
    "heading_lately", "miss_lately", "acceleration_towards", "distance_covered", "path_covered",
    "heading_last", "braking", "nearness", "remaining_of_size", "heading_relative",
)  # fmt: skip
"""Names of the features of each object."""
SHARED = (
    "speed_of_peak", "speed_time_covered", "braking_time", "path_excess", "peak_when",
    "speed_since_quarter", "speed_since_half", "half_of_quarter", "speed_since_three_quarters",
    "bend_since_half", "noise_of_way",
)  # fmt: skip
"""Names of the features of the movement, the same for every object."""
OF_ALL = ("nearness",)  # features of an object that moves that stay as they are
BESIDE = 0.1  # m; a hand that began its movement nearer to an object's cylinder carries it; guess
AHEAD = 0.12  # s, guess
MAX_AIM = 0.7  # of the half-length: people do not aim at the very ends; guess
MAX_RATIO = 8.0  # bound of ratios whose denominator may vanish
SMALL = 1e-12


class Features(NamedTuple):
    """Features of a movement.

    Attributes
    ----------
    local : (o, 22)
        Of each object, in the order of :data:`LOCAL`.
    shared : (11,)
        Of the movement, in the order of :data:`SHARED`.
    """

    local: Array
    shared: Array


@kernel
def _bounded(value):
    return min(max(value, -MAX_RATIO), MAX_RATIO)


@kernel
def _since(points, count, start, covered, part):
    """Return the last point that had covered less than a part of the present distance."""
    last = 0
    for k in range(count):
        away2 = 0.0
        for axis in range(3):
            away2 += (points[k, 1 + axis] - start[axis]) ** 2
        if away2 < (part * covered) ** 2:
            last = k
    return last


@kernel
def _features_of(state, points, now, cylinders, local, shared):
    """Write the result of :func:`features_of`, in the order of the names.

    ``state``, ``points`` and ``now`` are those of a ReachState, ``cylinders`` the rows.
    """
    count, objects = points.shape[0], cylinders.shape[0]
    p, v, a, start = now[0], now[1], now[2], start_of(state)
    t, onset, peak_t = times_of(state)
    peak, path_length = extent_of(state)
    elapsed = max(t - onset, 1e-3)
    speed2 = pull2 = covered2 = along_way = 0.0
    for axis in range(3):
        speed2 += v[axis] ** 2
        pull2 += a[axis] ** 2
        covered2 += (p[axis] - start[axis]) ** 2
        along_way += a[axis] * v[axis]
    speed, pull, covered = math.sqrt(speed2), math.sqrt(pull2), math.sqrt(covered2) + SMALL
    gain = along_way / (speed + SMALL)  # of speed
    quarter = points[_since(points, count, start, covered, 0.25)]
    half = points[_since(points, count, start, covered, 0.5)]
    last = points[_since(points, count, start, covered, 0.75)]
    shared[0] = speed / (peak + SMALL)
    shared[1] = speed * elapsed / covered
    shared[2] = gain * elapsed / (speed + SMALL)
    shared[3] = path_length / covered
    shared[4] = (peak_t - onset) / elapsed
    shared[5] = speed * (t - quarter[0]) / covered
    shared[6] = speed * (t - half[0]) / covered
    shared[7] = (t - half[0]) / (t - quarter[0] + 1e-3)
    shared[8] = speed * (t - last[0]) / covered
    shared[9] = gain * (t - half[0]) ** 2 / covered
    shared[10] = math.sqrt(noise_variance_of(state)) / covered
    for k in range(len(shared)):
        shared[k] = _bounded(shared[k])
    ahead, aim = np.empty(3), np.empty(3)
    for axis in range(3):
        ahead[axis] = p[axis] + AHEAD * (v[axis] + 0.5 * AHEAD * a[axis])
    nearest = math.inf
    for o in range(objects):
        centre, direction, velocity = (
            centre_of(cylinders[o]), axis_of(cylinders[o]), velocity_of(cylinders[o]),
        )  # fmt: skip
        half_length, radius = size_of(cylinders[o])
        along = 0.0
        for axis in range(3):
            along += (ahead[axis] - centre[axis]) * direction[axis]
        limit = MAX_AIM * half_length
        along = min(max(along, -limit), limit)
        left2 = way2 = miss2 = moves2 = closing = closing2 = 0.0
        done = towards = pulled = lately = finally_ = lately2 = last2 = 0.0
        for axis in range(3):
            aim[axis] = centre[axis] + along * direction[axis]
            left, way = aim[axis] - p[axis], aim[axis] - start[axis]
            left2 += left * left
            way2 += way * way
            miss2 += (aim[axis] - ahead[axis]) ** 2
            moves2 += velocity[axis] ** 2
            relative = v[axis] - velocity[axis]
            closing += relative * left
            closing2 += relative * relative
            done += (p[axis] - start[axis]) * way
            towards += v[axis] * left
            pulled += a[axis] * left
            lately += (p[axis] - half[1 + axis]) * left
            lately2 += (p[axis] - half[1 + axis]) ** 2
            finally_ += (p[axis] - last[1 + axis]) * left
            last2 += (p[axis] - last[1 + axis]) ** 2
        left, way = math.sqrt(left2) + SMALL, math.sqrt(way2) + SMALL
        way2 = max(way2, SMALL * SMALL)
        now_cosine = towards / (speed * left + SMALL)
        late_cosine = lately / (math.sqrt(lately2) * left + SMALL)
        row = local[o]
        row[0] = left / way
        row[1] = math.log((left + 0.05 * way) / (1.05 * way))
        row[2] = done / way2
        row[3] = math.sqrt(max(0.0, covered2 / way2 - row[2] ** 2))
        row[4] = now_cosine
        row[5] = done / (covered * way)
        row[6] = speed * elapsed / way
        row[7] = peak * elapsed / way
        row[8] = math.sqrt(miss2) / way
        row[9] = left * math.sqrt(max(0.0, 1.0 - now_cosine**2)) / way
        row[10] = max(left - radius, 0.0) / way
        row[11] = math.sqrt(moves2) / (speed + SMALL)
        row[12] = late_cosine
        row[13] = left * math.sqrt(max(0.0, 1.0 - late_cosine**2)) / way
        row[14] = pulled / (pull * left + SMALL)
        row[15] = covered / way
        row[16] = path_length / way
        row[17] = finally_ / (math.sqrt(last2) * left + SMALL)
        row[18] = gain * elapsed**2 / way
        size = radius + half_length
        row[20] = math.log((left + 0.2 * size) / size)
        row[21] = closing / (math.sqrt(closing2) * left + SMALL)
        nearest = min(nearest, left)
        row[19] = 0.0
        for k in range(len(row)):
            row[k] = _bounded(row[k])
        row[19] = left
    for o in range(objects):
        local[o, 19] = math.log((nearest / local[o, 19] + 0.1) / 1.1)


def _see_from(reach: ReachState, path: Array, cylinder: Cylinders, row: Array) -> None:
    """Write the features of an object that moves: of the approach as seen from it."""
    seen, ahead = approach_of(reach, path, cylinder.velocity[0])
    there, own, unused = cylinder.rows.copy(), np.empty((1, len(LOCAL))), np.empty(len(SHARED))
    centre_of(there[0])[:] += ahead
    velocity_of(there[0])[:] = 0.0
    if Cylinders(there).distance(0, seen.start) < BESIDE:
        return
    _features_of(seen.state, seen.points, seen.now, there, own, unused)
    for k in range(len(LOCAL)):
        if LOCAL[k] not in OF_ALL:
            row[k] = own[0, k]


def features_of(reach: ReachState, cylinders: Cylinders) -> Features:
    """Return the features of a movement.

    Of an object that moves they are those of the approach as seen from it, as if it stood: a hand
    meets it, or it is brought to the hand. Not so where the hand was beside the object when its
    movement began: it carries the object.

    Parameters
    ----------
    reach : ReachState
        Of a hand that moves or may have begun to.
    cylinders : Cylinders
        Of the objects.
    """
    local, shared = np.empty((len(cylinders.rows), len(LOCAL))), np.empty(len(SHARED))
    _features_of(reach.state, reach.points, reach.now, cylinders.rows, local, shared)
    for o, path in cylinders.paths.items():
        _see_from(reach, path, cylinders.one(o), local[o])
    return Features(local, shared)
