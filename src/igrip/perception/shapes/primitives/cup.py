"""``cup``: an upright cylinder or cone that is open at its top: cups, mugs, bowls, plates."""

from __future__ import annotations

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays, entered
from igrip.perception.shapes.primitives._cone import (
    SECTIONS,
    STEPS,
    UP,
    cone_of,
    cone_radii,
    cone_start,
    inside,
)
from igrip.rgbd import Array

WALL = 0.005  # m; a guess: cameras hardly see how thick walls are
MAX_WALL = 0.25  # of the radius, and of the height


@PRIMITIVES.register("cup")
class Cup:
    """Parameters: those of :func:`igrip.perception.shapes.primitives._cone.cone_of`."""

    symmetry: Symmetry = "cylinder"
    axis = UP
    cost = 0.012
    steps = STEPS
    wall = WALL

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        return cone_start(footprint)

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Where rays meet its outside, or, through its opening, its inside."""
        cone = cone_of(parameters)
        near, far, plane = inside(cone, rays)
        wall = _wall(cone.low, cone.top, cone.height)
        hollow = cone._replace(low=cone.low - wall, top=cone.top - wall)
        inner_near, inner_far, _ = inside(hollow, rays, wall)
        through = (inner_near < inner_far) & (inner_near <= plane + 1e-9)
        return np.where(through, inner_far, entered(near, far))

    def unlikely(self, parameters: Array) -> float:
        """Nothing is."""
        return 0.0

    def height(self, parameters: Array) -> float:
        """Of its rim."""
        return cone_of(parameters).height

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of its outside."""
        return cone_radii(parameters, heights, angles)

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return a surface of revolution with an inside."""
        _, _, low, top, h = cone_of(parameters)
        wall = _wall(low, top, h)
        profile = np.array([
            (0.0, 0.0), (low, 0.0), (0.5 * (low + top), 0.5 * h), (top, h), (top - wall, h),
            (0.5 * (low + top) - wall, 0.5 * h + 0.5 * wall), (low - wall, wall), (0.0, wall),
        ])  # fmt: skip
        return trimesh.creation.revolve(profile, sections=SECTIONS)


def _wall(low: float, top: float, height: float) -> float:
    return min(WALL, MAX_WALL * min(low, top, height))
