"""Upright cones between two planes: what cylinders and cups are made of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from igrip.compiled import kernel
from igrip.perception.shapes.primitives import Footprint, Rays
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


def cone_radii(parameters: Array, heights: Array, angles: Array) -> Array:
    """Return the radius at each height (n,), in all directions (m,) alike, (n, m) [m]."""
    cone = cone_of(parameters)
    across = cone.low + (cone.top - cone.low) * np.minimum(heights / cone.height, 1.0)
    return np.repeat(across[:, None], len(angles), axis=1)


def inside(cone: Cone, rays: Rays, foot: float = 0.0) -> tuple[Array, Array, Array]:
    """Return where rays (m,) enter and leave a cone, and where they pass its upper plane.

    ``foot`` is the height at which it begins [m]. A ray that enters after it leaves misses.
    """
    near, far, plane = np.empty((3, len(rays.directions)))
    origin = rays.origin - (cone.x, cone.y, 0.0)
    _inside(origin, rays.directions, cone.low, cone.top, cone.height, foot, near, far, plane)
    return near, far, plane


@kernel
def _inside(origin, directions, low, top, height, foot, near, far, plane):
    slope = (top - low) / height
    ox, oy, oz = origin[0], origin[1], origin[2]
    r = low + slope * oz
    c = ox * ox + oy * oy - r * r
    for n in range(directions.shape[0]):
        dx, dy, dz = directions[n, 0], directions[n, 1], directions[n, 2]
        a = dx * dx + dy * dy - slope * slope * dz * dz
        b = ox * dx + oy * dy - r * slope * dz
        inner = b * b - a * c
        begin, end = -np.inf, np.inf
        if inner < 0.0 or a == 0.0:
            if a > 0.0:
                begin, end = np.inf, -np.inf
        else:
            root = np.sqrt(inner)
            one, two = (-b - root) / a, (-b + root) / a
            begin, end = min(one, two), max(one, two)
            if a < 0.0:
                # steeper than the cone: inside beyond the roots, towards where the cone widens
                if slope * dz < 0.0:
                    begin, end = -np.inf, begin
                else:
                    begin, end = end, np.inf
        if dz == 0.0:
            plane[n] = np.inf
            if oz < foot or oz > height:
                begin, end = np.inf, -np.inf
        else:
            upper, lower = (height - oz) / dz, (foot - oz) / dz
            plane[n] = upper
            begin, end = max(begin, min(upper, lower)), min(end, max(upper, lower))
        near[n], far[n] = begin, end


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
