"""Opposing contacts: two points of a surface that can be pressed together without slipping.

Nguyen (1988): two contacts with friction hold an object if the line between them lies within both
friction cones. Points are taken from the sample of the surface, so that a grasp over a cavity (the
body of a mug) is found as well as one of its wall.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.grasps.surface import PATCH, Surface

Array = NDArray[np.float64]

MAX_OPENING = 0.12  # m; between thumb and fingers of an adult's hand
MIN_OPENING = 0.001  # m; nearer points are one surface
FRICTION_ANGLE = math.radians(25.0)  # a coefficient of 0.47, dry skin on plastic
SEARCH_ANGLE = math.radians(20.0)  # of the far normal; pairs are sought well within the cones
SEEDS = 800
LAYER = 0.012  # m; of a point's partners at about one distance the best alone is kept


class Oppositions(NamedTuple):
    """Pairs of opposing contacts.

    Attributes
    ----------
    centre : (p, 3)
        Midway between them [m].
    closing : (p, 3)
        Unit vectors from one to the other.
    opening : (p,)
        Distance between them [m].
    quality : (p,)
        1 where both normals lie on the line, 0 at the border of the search.
    """

    centre: Array
    closing: Array
    opening: Array
    quality: Array


def find_oppositions(surface: Surface, seeds: int = SEEDS) -> Oppositions:
    """Find opposing contacts: from points of a surface straight inwards to other parts of it."""
    points, normals = surface
    first = np.arange(0, len(points), max(1, len(points) // seeds))
    layers = int(MAX_OPENING / LAYER) + 1
    opening, aside = np.zeros((len(first), layers)), np.full((len(first), layers), PATCH)
    quality = np.zeros((len(first), layers))
    _oppose(points, normals, first, math.cos(SEARCH_ANGLE), opening, aside, quality)
    row, layer = np.nonzero(quality > 0.0)
    closing, width = -normals[first[row]], opening[row, layer]
    centre = points[first[row]] + 0.5 * width[:, None] * closing
    return Oppositions(centre, closing, width, quality[row, layer])


@kernel
def _oppose(points, normals, first, least, opening, aside, quality):
    """Write where the line inwards from each point leaves the object, at each distance.

    It leaves through the tangent plane of the sampled point that it passes nearest by: a thin wall
    would else need a sample right opposite.
    """
    for row in range(first.shape[0]):
        i = first[row]
        for j in range(points.shape[0]):
            facing = along = ahead = square = 0.0
            for axis in range(3):
                way = points[j, axis] - points[i, axis]
                facing -= normals[i, axis] * normals[j, axis]
                along += way * normals[j, axis]
                ahead -= way * normals[i, axis]
                square += way * way
            if facing < least:
                continue
            d = along / facing
            off = math.sqrt(max(square - ahead * ahead, 0.0))
            if d < MIN_OPENING or d > MAX_OPENING:
                continue
            layer = int(d / LAYER)
            if off < aside[row, layer]:
                aside[row, layer], opening[row, layer] = off, d
                quality[row, layer] = (facing - least) / (1.0 - least)
