"""``bottle``: an upright oval body under a shoulder that narrows to a neck."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays, entered
from igrip.perception.shapes.primitives._cone import (
    SECTIONS,
    Cone,
    flatness_prior,
    flattened,
    inside,
)
from igrip.rgbd import Array

ROUNDEST, FLATTEST = 1.0, 0.3  # shorter over longer axis
LOWEST, HIGHEST = 0.3, 0.95  # height of the shoulder's foot over that of the bottle
NARROWEST, WIDEST = 0.15, 0.9  # neck over body


class _Sizes(NamedTuple):
    """Parts of a bottle [m]; radii are those along the longer axis."""

    x: float
    y: float
    radius: float
    height: float
    shoulder: float  # height of its foot
    neck: float  # radius at the top
    flat: float  # shorter over longer axis
    yaw: float


@PRIMITIVES.register("bottle")
class Bottle:
    """A body, a shoulder and a neck.

    Parameters: x, y, logarithms of the longer half axis and of the height, share of the height
    at which the shoulder begins, neck over body, shorter over longer axis, yaw of the longer.
    """

    symmetry: Symmetry = "box"
    axis = np.array([0.0, 0.0, 1.0])
    cost = 0.02
    steps = np.array([0.008, 0.008, 0.12, 0.06, -0.1, 0.15, -0.15, 0.3])
    wall = None

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        longer, shorter = np.maximum(footprint.half, 0.005)
        flat = np.clip(shorter / longer, 0.5, 0.9)
        return np.array([
            *footprint.middle, np.log(longer), np.log(footprint.height), 0.7, 0.4, flat,
            footprint.yaw,
        ])  # fmt: skip

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Where rays enter the body or the shoulder; the shorter axis is stretched."""
        size = _sizes(parameters)
        turned = flattened(rays, size.x, size.y, size.yaw, size.flat)
        body = Cone(0.0, 0.0, size.radius, size.radius, size.shoulder)
        slope = (size.neck - size.radius) / (size.height - size.shoulder)
        cone = Cone(0.0, 0.0, size.radius - slope * size.shoulder, size.neck, size.height)
        near, far, _ = inside(body, turned)
        above_near, above_far, _ = inside(cone, turned, size.shoulder)
        return np.minimum(entered(near, far), entered(above_near, above_far))

    def unlikely(self, parameters: Array) -> float:
        """By how flat it is: its back is not seen."""
        return flatness_prior(_sizes(parameters).flat)

    def height(self, parameters: Array) -> float:
        """Of its neck."""
        return _sizes(parameters).height

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of ellipses."""
        size = _sizes(parameters)
        over = np.clip((heights - size.shoulder) / (size.height - size.shoulder), 0.0, 1.0)
        across = size.radius + (size.neck - size.radius) * over
        turned = angles - size.yaw
        round_one = 1.0 / np.hypot(np.cos(turned), np.sin(turned) / size.flat)
        return np.asarray(across[:, None] * round_one[None, :])

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return a surface of revolution, stretched and turned."""
        _, _, r, h, shoulder, neck, flat, yaw = _sizes(parameters)
        profile = np.array([(0, 0), (r, 0), (r, 0.5 * shoulder), (r, shoulder), (neck, h), (0, h)])
        mesh = trimesh.creation.revolve(profile, sections=SECTIONS)
        mesh.apply_scale((1.0, flat, 1.0))
        mesh.apply_transform(trimesh.transformations.rotation_matrix(yaw, (0, 0, 1)))
        return mesh


def _sizes(parameters: Array) -> _Sizes:
    x, y, radius, height, share, neck, flat, yaw = parameters.tolist()
    r, h = float(np.exp(radius)), float(np.exp(height))
    shoulder = h * float(np.clip(share, LOWEST, HIGHEST))
    narrow = r * float(np.clip(neck, NARROWEST, WIDEST))
    return _Sizes(x, y, r, h, shoulder, narrow, float(np.clip(flat, FLATTEST, ROUNDEST)), yaw)
