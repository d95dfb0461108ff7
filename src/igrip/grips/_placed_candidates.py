"""Grasp candidates of a frame's objects, in the world, against the movement of one hand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.geometry.cylinder import axis_of, centre_of, size_of
from igrip.grasps.candidate import CLEARANCE, ON_AXIS, Candidate
from igrip.grasps.hand_fit import FINGER
from igrip.taxonomy import NAMES

Array = NDArray[np.float64]

# columns, used in this file and by _choice.py alone
PALM, APPROACH, CLOSING, POINT, PIVOT, AXIS = 0, 3, 6, 9, 12, 15
LOW, HIGH, OPENING, PRIOR, WIDTH = 18, 19, 20, 21, 22
MAX_MISFIT = 30.0  # of squared distances over variances: no outlier decides alone
UNDER = 0.03  # m; a palm so near over the lowest point of an object is below what it stands on
LEVEL = 0.3  # of the closing direction's height: below it the fingers are beside the object
BLOCKED = 6.0  # log-odds against such a candidate


class PackedCandidates(NamedTuple):
    """Candidates of several models, one after the other.

    Attributes
    ----------
    rows : (k, 22)
        As this file lays them out, in the frames of their meshes.
    grip : (k,) int64
        Index in :data:`igrip.taxonomy.NAMES`.
    owner : (k,) int64
        Number of the object.
    """

    rows: Array
    grip: NDArray[np.int64]
    owner: NDArray[np.int64]


def pack_candidates(every: Sequence[Sequence[Candidate]]) -> PackedCandidates:
    """Put the candidates of each object one after the other."""
    flat = [(o, candidate) for o, some in enumerate(every) for candidate in some]
    rows = np.array([
        (*c.palm(CLEARANCE), *c.approach, *c.closing, *c.point, *c.pivot, *c.axis, *c.turns,
         c.opening, 0.5 * math.log(max(c.weight, 1e-6)))
        for _, c in flat
    ]).reshape(-1, WIDTH)  # fmt: skip
    grip = np.array([NAMES.index(c.grip) for _, c in flat], dtype=np.int64)
    return PackedCandidates(rows, grip, np.array([o for o, _ in flat], dtype=np.int64))


@kernel
def _azimuth(axis, own, goal):
    """Return the angle about an axis between the parts of two vectors across it; NaN for none."""
    a = b = 0.0
    for k in range(3):
        a += own[k] * axis[k]
        b += goal[k] * axis[k]
    dot = own2 = goal2 = 0.0
    for k in range(3):
        p, q = own[k] - a * axis[k], goal[k] - b * axis[k]
        dot += p * q
        own2 += p * p
        goal2 += q * q
    if own2 < 1e-12 or goal2 < 1e-12:
        return np.nan
    turned = (
        axis[0] * (own[1] * goal[2] - own[2] * goal[1])
        + axis[1] * (own[2] * goal[0] - own[0] * goal[2])
        + axis[2] * (own[0] * goal[1] - own[1] * goal[0])
    )
    return math.atan2(turned, dot)


@kernel
def _allowed(angle, period, low, high):
    """Return the turn within bounds that is nearest to an angle, which repeats."""
    best, least = 0.0, np.inf
    for k in range(-2, 3):
        turn = angle + k * period
        clipped = min(max(turn, low), high)
        off = abs(turn - clipped) + 1e-9 * abs(turn)
        if off < least:
            least, best = off, clipped
    return best


@kernel
def _turned(row, at, offset, angle, out):
    """Write a vector of a row, or a point from its pivot, turned about its axis (Rodrigues)."""
    cos, sin = math.cos(angle), math.sin(angle)
    v = np.empty(3)
    along = 0.0
    for k in range(3):
        v[k] = row[at + k] - offset * row[PIVOT + k]
        along += v[k] * row[AXIS + k]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        cross = row[AXIS + i] * v[j] - row[AXIS + j] * v[i]
        out[k] = v[k] * cos + cross * sin + row[AXIS + k] * along * (1.0 - cos)
        out[k] += offset * row[PIVOT + k]


@kernel
def place(
    rows, owner, rotations, translations, cylinders, soon, spread, heading, chord, across, ahead,
    weights, score, vectors, free,
):  # fmt: skip
    """Place candidates in the world, each turned as the hand suggests, and weigh them.

    Parameters
    ----------
    rows, owner : (k, 22), (k,)
        Of :class:`PackedCandidates`.
    rotations, translations : (o, 3, 3), (o, 3)
        World-from-mesh pose of each object [m].
    cylinders : (o, 11)
        Rows of :class:`igrip.geometry.cylinder.Cylinders`.
    soon, spread : (3,), float
        Where the palm is expected at contact, and the standard deviation of that [m].
    heading : (3,)
        Unit vector of the hand's velocity; zero if it hardly moves.
    chord : (3,)
        Level unit vector of the way from rest to the target; zero if unknown.
    across, ahead : (3,)
        As :class:`igrip.motion.palm_axes.PalmAxes`; zero if unknown.
    weights : 3 floats
        Of the heading, of the way the hand points, and of how it is turned.
    score : (k,), written
        Log-probabilities, up to a constant of each object.
    vectors : (k, 4, 3), written
        Palm, approach, closing and point, world frame [m].
    free : (k,), written
        Largest roll about the approach that is as good [rad].
    """
    own, goal, side = np.empty(3), np.empty(3), np.empty(3)
    local = np.empty((4, 3))
    for c in range(rows.shape[0]):
        row, o = rows[c], owner[c]
        rotation, translation = rotations[o], translations[o]
        low, high = row[LOW], row[HIGH]
        angle, free[c] = 0.0, 0.0
        if high > low:
            off2 = along = 0.0
            for k in range(3):
                own[k] = row[PALM + k] - row[PIVOT + k]
                along += own[k] * row[AXIS + k]
            for k in range(3):
                off2 += (own[k] - along * row[AXIS + k]) ** 2
                goal[k] = -row[PIVOT + k]
                for i in range(3):
                    goal[k] += rotation[i, k] * (soon[i] - translation[i])
            period = 2.0 * math.pi
            if off2 < ON_AXIS * ON_AXIS:  # a turn leaves the palm and rolls the hand
                free[c] = min(0.5 * (high - low), 0.5 * math.pi)
                period = math.pi
                for k in range(3):
                    own[k], side[k], goal[k] = row[CLOSING + k], 0.0, 0.0
                # the closing direction is across the hand's own axis; unknown: along the reach
                known = across[0] ** 2 + across[1] ** 2 + across[2] ** 2 > 0.5
                for k in range(3):
                    for i in range(3):
                        side[k] += rotation[i, k] * (across[i] if known else chord[i])
                for k in range(3):
                    i, j = (k + 1) % 3, (k + 2) % 3
                    goal[k] = side[k]
                    if known:
                        goal[k] = side[i] * row[APPROACH + j] - side[j] * row[APPROACH + i]
                free[c] = 0.0 if known else free[c]
            turn = _azimuth(row[AXIS : AXIS + 3], own, goal)
            if not math.isnan(turn):
                angle = _allowed(turn, period, low, high)
        _turned(row, PALM, 1.0, angle, local[0])
        _turned(row, APPROACH, 0.0, angle, local[1])
        _turned(row, CLOSING, 0.0, angle, local[2])
        _turned(row, POINT, 1.0, angle, local[3])
        out = vectors[c]
        for v in range(4):
            for k in range(3):
                out[v, k] = translation[k] if v == 0 or v == 3 else 0.0
                for i in range(3):
                    out[v, k] += rotation[k, i] * local[v, i]
        miss2 = towards = points = turned = 0.0
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            miss2 += (soon[k] - out[0, k]) ** 2
            towards += heading[k] * out[1, k]
            points += ahead[k] * out[1, k]
            turned += across[k] * (out[1, i] * out[2, j] - out[1, j] * out[2, i])
        found = row[PRIOR] - 0.5 * min(miss2 / (spread * spread), MAX_MISFIT)
        found += weights[0] * towards + weights[1] * points + weights[2] * turned * turned
        cylinder = cylinders[o]
        half, radius = size_of(cylinder)
        upright = abs(axis_of(cylinder)[2])
        lowest = centre_of(cylinder)[2] - half * upright
        lowest -= radius * math.sqrt(max(1.0 - upright * upright, 0.0))
        # what it stands on is in the way of the palm, or of the finger below
        below = out[3, 2] - (0.5 * row[OPENING] + FINGER) * abs(out[2, 2])
        if out[0, 2] < lowest + UNDER or (abs(out[2, 2]) > LEVEL and below < lowest):
            found -= BLOCKED
        score[c] = found
