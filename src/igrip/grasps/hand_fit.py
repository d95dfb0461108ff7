"""Whether a hand fits round two opposing contacts, and what it finds between its fingers.

The hand is a thumb and a finger, each a corridor along the approach outside of a contact, and a
palm behind what lies between them. Its frame at a pair of contacts: the approach ``w``, the closing
direction ``u`` from thumb to fingers, and ``v = w × u`` across the palm.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.grasps.opposition import Oppositions
from igrip.grasps.surface import Surface

Array = NDArray[np.float64]

DIRECTIONS = 16  # approaches tried round each pair
FINGER = 0.012  # m; thickness
SLACK = 0.004  # m; between finger and surface beside the contact
FINGER_LENGTH = 0.075  # m; from the palm to where it presses
HALF_PALM = 0.025  # m; breadth to each side that has to be free behind the object
SLAB = 0.015  # m; half-breadth of what counts as between the fingers
BIN, BINS = 0.006, 41  # along approach and palm; the middle bin holds the centre
GAP = 2  # empty bins in a row end a part
MIDDLE = BINS // 2
FEATURES = 10
BACK, FRONT, BELOW, ABOVE, TALL, SIDES, BEYOND, PLANAR, FACING, FREE = range(FEATURES)


class HandFits(NamedTuple):
    """Hands that fit, each at a pair of contacts from one direction. Arrays of one length.

    Attributes
    ----------
    centre, approach, closing : (g, 3)
        Midway between the contacts [m]; unit vectors.
    opening, quality : (g,)
        [m], and as :class:`igrip.grasps.opposition.Oppositions`.
    features : (g, 10)
        ``BACK``, ``FRONT``: how far the part reaches towards the palm and away from it [m].
        ``BELOW``, ``ABOVE``: along the palm, with both sides as wide as here [m]. ``TALL``: along
        the palm, however wide [m]. ``SIDES``: along the approach, with both sides as wide as here
        [m]. ``BEYOND``: 1 if there is free space and more of the object ahead. ``PLANAR``: share
        of the points ahead within the thickness. ``FACING``: cosine between the approach and the
        surface that the palm meets. ``FREE``: 1.
    """

    centre: Array
    approach: Array
    closing: Array
    opening: Array
    quality: Array
    features: Array


def fit_hands(surface: Surface, pairs: Oppositions, reference: Array) -> HandFits:
    """Try approaches at each pair; ``reference`` (3,) is where the turns round it begin."""
    count = len(pairs.opening)
    approach = np.empty((count, DIRECTIONS, 3))
    features = np.zeros((count, DIRECTIONS, FEATURES))
    aside = np.eye(3)[np.argmin(np.abs(reference))]
    _fit(
        surface.points, surface.normals, pairs.centre, pairs.closing, pairs.opening, reference,
        aside, approach, features,
    )  # fmt: skip
    pair, k = np.nonzero(features[:, :, FREE] > 0.0)
    return HandFits(
        pairs.centre[pair], approach[pair, k], pairs.closing[pair], pairs.opening[pair],
        pairs.quality[pair], features[pair, k],
    )  # fmt: skip


@kernel
def _run(filled, step):
    """Return how many bins from the middle on are filled, small gaps included."""
    last, empty, k = 0, 0, 1
    while k <= MIDDLE and empty < GAP:
        if filled[MIDDLE + step * k]:
            last, empty = k, 0
        else:
            empty += 1
        k += 1
    return last


@kernel
def _fit(points, normals, centres, closings, openings, reference, aside, approach, features):
    """Write approaches and what the hand finds from each."""
    local = np.empty((points.shape[0], 3))
    which = np.empty(points.shape[0], dtype=np.int64)
    depth = np.zeros(BINS, dtype=np.bool_)
    tall = np.zeros(BINS, dtype=np.bool_)
    thumb = np.zeros(BINS, dtype=np.bool_)
    other = np.zeros(BINS, dtype=np.bool_)
    both = np.zeros(BINS, dtype=np.bool_)
    thumb_side = np.zeros(BINS, dtype=np.bool_)
    other_side = np.zeros(BINS, dtype=np.bool_)
    reach = BIN * (MIDDLE + 0.5)
    x = np.empty(3)
    for p in range(centres.shape[0]):
        u, half = closings[p], 0.5 * openings[p]
        dot = u[0] * reference[0] + u[1] * reference[1] + u[2] * reference[2]
        base = reference if abs(dot) < 0.9 else aside
        dot = u[0] * base[0] + u[1] * base[1] + u[2] * base[2]
        norm = 0.0
        for axis in range(3):
            x[axis] = base[axis] - dot * u[axis]
            norm += x[axis] ** 2
        x /= math.sqrt(norm)
        y0 = u[1] * x[2] - u[2] * x[1]
        y1 = u[2] * x[0] - u[0] * x[2]
        y2 = u[0] * x[1] - u[1] * x[0]
        near = 0
        for k in range(points.shape[0]):
            q0, q1, q2 = (points[k, 0] - centres[p, 0], points[k, 1] - centres[p, 1],
                          points[k, 2] - centres[p, 2])  # fmt: skip
            b = q0 * u[0] + q1 * u[1] + q2 * u[2]
            if abs(b) > half + 0.06 or q0 * q0 + q1 * q1 + q2 * q2 > 0.03:
                continue
            local[near, 0] = q0 * x[0] + q1 * x[1] + q2 * x[2]
            local[near, 1] = q0 * y0 + q1 * y1 + q2 * y2
            local[near, 2] = b
            which[near] = k
            near += 1
        for d in range(DIRECTIONS):
            angle = 2.0 * math.pi * d / DIRECTIONS
            cos, sin = math.cos(angle), math.sin(angle)
            for axis in range(3):
                y = y0 if axis == 0 else (y1 if axis == 1 else y2)
                approach[p, d, axis] = cos * x[axis] + sin * y
            depth[:] = False
            for k in range(near):
                a = cos * local[k, 0] + sin * local[k, 1]
                e = -sin * local[k, 0] + cos * local[k, 1]
                if abs(e) < SLAB and abs(local[k, 2]) < half + SLACK and abs(a) < reach:
                    depth[int(a / BIN + MIDDLE + 0.5)] = True
            back, front = BIN * _run(depth, -1), BIN * _run(depth, 1)
            if back > FINGER_LENGTH:
                continue
            ahead = met = 0
            facing = 0.0
            blocked = planar = looked = 0
            tall[:] = False
            thumb[:] = False
            other[:] = False
            thumb_side[:] = False
            other_side[:] = False
            for k in range(near):
                a = cos * local[k, 0] + sin * local[k, 1]
                e = -sin * local[k, 0] + cos * local[k, 1]
                b = abs(local[k, 2])
                if abs(e) < 0.008 and -back < a < 0.004 and half + SLACK < b < half + FINGER:
                    blocked += 1
                if abs(e) < HALF_PALM and b < 0.03 and -back - 0.06 < a < -back - 0.01:
                    blocked += 1
                if blocked > 1:
                    break
                if abs(e) < SLAB and b < half + SLACK and front + 0.012 < a < front + 0.08:
                    ahead += 1
                if abs(e) < SLAB and b < 0.5 * half + 0.002 and abs(a + back) < BIN:
                    at, met = which[k], met + 1
                    for axis in range(3):
                        facing -= normals[at, axis] * approach[p, d, axis]
                if 0.0 < a < 0.06 and abs(e) < 0.03 and b < half + 0.05:
                    looked += 1
                    planar += b < half + SLACK
                if abs(e) < 0.012 and abs(a) < reach and abs(b - half) < 0.15 * half + 0.003:
                    at = int(a / BIN + MIDDLE + 0.5)
                    if local[k, 2] < 0.0:
                        thumb_side[at] = True
                    else:
                        other_side[at] = True
                if abs(a) < 0.012 and abs(e) < reach:
                    at = int(e / BIN + MIDDLE + 0.5)
                    if b < half + SLACK:
                        tall[at] = True
                    if abs(b - half) < 0.15 * half + 0.003:
                        if local[k, 2] < 0.0:
                            thumb[at] = True
                        else:
                            other[at] = True
            if blocked > 1:
                continue
            for k in range(BINS):
                both[k] = thumb[k] and other[k]
            out = features[p, d]
            out[BACK], out[FRONT] = back, front
            out[BELOW], out[ABOVE] = BIN * (_run(both, -1) + 0.5), BIN * (_run(both, 1) + 0.5)
            for k in range(BINS):
                both[k] = thumb_side[k] and other_side[k]
            out[SIDES] = BIN * (_run(both, -1) + _run(both, 1) + 1)
            out[TALL] = BIN * (_run(tall, -1) + _run(tall, 1) + 1)
            out[BEYOND] = 1.0 if ahead > 2 else 0.0
            out[PLANAR] = planar / looked if looked > 0 else 0.0
            out[FACING] = facing / met if met > 0 else 0.0
            out[FREE] = 1.0
