"""Upright cones between two planes: what cylinders and cups are made of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from igrip.perception.shapes.primitives import Footprint, Rays, slab
from igrip.rgbd import Array

UP = np.array([0.0, 0.0, 1.0])
SECTIONS = 48
MIN_RATIO, MAX_RATIO = 0.3, 2.5  # of the radius at the foot to that at the top
STEPS = np.array([0.008, 0.008, 0.12, 0.12, 0.06])


class Cone(NamedTuple):
    """Its middle on the table, and its sizes [m]."""

    x: float
    y: float
    low: float  # radius at the foot
    top: float  # radius at the top
    height: float


def cone_of(parameters: Array) -> Cone:
    """Return the cone of x, y, logarithms of the upper radius, of foot over top, of the height."""
    x, y, top, ratio, height = parameters
    top = float(np.exp(top))
    ratio = float(np.clip(np.exp(ratio), MIN_RATIO, MAX_RATIO))
    return Cone(float(x), float(y), ratio * top, top, float(np.exp(height)))


def cone_start(footprint: Footprint) -> Array:
    """Return parameters of an upright cylinder on a footprint."""
    radius = max(float(footprint.half.mean()), 0.005)
    return np.array([*footprint.middle, np.log(radius), 0.0, np.log(footprint.height)])


def inside(cone: Cone, rays: Rays, foot: float = 0.0) -> tuple[Array, Array, Array]:
    """Return where rays (m,) enter and leave a cone, and where they pass its upper plane.

    ``foot`` is the height at which it begins [m]. A ray that enters after it leaves misses.
    """
    slope = (cone.top - cone.low) / cone.height
    o, d = rays.origin - (cone.x, cone.y, 0.0), rays.directions
    r = cone.low + slope * o[2]
    a = d[:, 0] ** 2 + d[:, 1] ** 2 - (slope * d[:, 2]) ** 2
    b = o[0] * d[:, 0] + o[1] * d[:, 1] - r * slope * d[:, 2]
    c = o[0] ** 2 + o[1] ** 2 - r**2
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        one, two = (-b - root) / a, (-b + root) / a
    near = np.nan_to_num(np.fmin(one, two), nan=np.inf)
    far = np.nan_to_num(np.fmax(one, two), nan=-np.inf)
    steep = a <= 0.0  # steeper than the cone: outside between the roots
    near = np.where(steep, far, near)
    far = np.where(steep, np.inf, far)
    half = 0.5 * (cone.height - foot)
    slab(near, far, float(o[2] - foot - half), d[:, 2], half)
    with np.errstate(divide="ignore"):
        plane = (cone.height - o[2]) / d[:, 2]
    return near, far, plane
