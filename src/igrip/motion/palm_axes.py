"""How a hand is turned: by its landmarks, or by its orientation."""

from __future__ import annotations

import math
from typing import NamedTuple

from igrip.entities import Hand, Vector

LANDMARKS = 21  # in the order of MediaPipe: wrist, then four from the root of each finger outwards
WRIST, INDEX, MIDDLE, LITTLE = 0, 5, 9, 17
THUMB_TIP, INDEX_TIP, MIDDLE_TIP = 4, 8, 12


class PalmAxes(NamedTuple):
    """Two directions of a hand, unit vectors in the world frame.

    Attributes
    ----------
    across : 3 floats
        From the knuckle of the index finger to that of the little finger: the axis about which the
        fingers close.
    ahead : 3 floats
        From the palm to where thumb and fingers meet.
    """

    across: Vector
    ahead: Vector


def palm_axes(hand: Hand) -> PalmAxes | None:
    """Return how a hand is turned; None where its source does not tell, or its landmarks coincide.

    Landmarks come before the orientation. An orientation's x axis points across the palm, from the
    index finger's side to the little finger's, and its z axis out of the palm.
    """
    if hand.landmarks is not None and len(hand.landmarks) == LANDMARKS:
        points = hand.landmarks
        palm = _mean(points[WRIST], points[INDEX], points[LITTLE])
        meeting = _mean(points[THUMB_TIP], _mean(points[INDEX_TIP], points[MIDDLE_TIP]))
        across = _unit(_minus(points[LITTLE], points[INDEX]))
        ahead = _unit(_minus(meeting, palm))
        return None if across is None or ahead is None else PalmAxes(across, ahead)
    if hand.orientation is None:
        return None
    x, y, z, w = hand.orientation
    scale = 2.0 / (x * x + y * y + z * z + w * w)
    return PalmAxes(
        (1.0 - scale * (y * y + z * z), scale * (x * y + w * z), scale * (x * z - w * y)),
        (scale * (x * z + w * y), scale * (y * z - w * x), 1.0 - scale * (x * x + y * y)),
    )


def _mean(*points: Vector) -> Vector:
    n = len(points)
    return (
        sum(p[0] for p in points) / n,
        sum(p[1] for p in points) / n,
        sum(p[2] for p in points) / n,
    )


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _unit(v: Vector) -> Vector | None:
    norm = math.hypot(*v)
    return (v[0] / norm, v[1] / norm, v[2] / norm) if norm > 1e-6 else None
