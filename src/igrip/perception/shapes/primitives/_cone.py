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
    inner = b * b - a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(inner)
        one, two = (-b - root) / a, (-b + root) / a
    near = np.nan_to_num(np.fmin(one, two), nan=np.inf)
    far = np.nan_to_num(np.fmax(one, two), nan=-np.inf)
    # a ray steeper than the cone is inside it beyond the roots, towards where the cone widens
    steep, ahead = a <= 0.0, slope * d[:, 2] < 0.0
    begin, end = np.where(ahead, -np.inf, far), np.where(ahead, near, np.inf)
    always = inner < 0.0
    near = np.where(steep, np.where(always, -np.inf, begin), near)
    far = np.where(steep, np.where(always, np.inf, end), far)
    half = 0.5 * (cone.height - foot)
    slab(near, far, float(o[2] - foot - half), d[:, 2], half)
    with np.errstate(divide="ignore"):
        plane = (cone.height - o[2]) / d[:, 2]
    return near, far, plane


def flattened(rays: Rays, x: float, y: float, yaw: float, flat: float) -> Rays:
    """Return rays in the frame of an oval at (x, y), stretched across until it is round."""
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, s, 0.0], [-s / flat, c / flat, 0.0], [0.0, 0.0, 1.0]])
    return Rays(turn @ (rays.origin - (x, y, 0.0)), rays.directions @ turn.T)


def flatness_prior(flat: float) -> float:
    """Return what is added to the misfit of an oval: most bottles are about 0.7 as thick as wide.

    Its back is not seen, so that little else says how thick it is; guess.
    """
    return 0.01 * float((np.log(flat / 0.7) / 0.25) ** 2)
