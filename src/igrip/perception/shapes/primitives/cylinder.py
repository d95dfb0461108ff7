"""``cylinder``: stands upright, closed; it may widen or narrow towards its top."""

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


@PRIMITIVES.register("cylinder")
class Cylinder:
    """Parameters: those of :func:`igrip.perception.shapes.primitives._cone.cone_of`."""

    symmetry: Symmetry = "cylinder"
    axis = UP
    cost = 0.01
    steps = STEPS
    wall = None

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        return cone_start(footprint)

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Where rays enter a cone between two planes."""
        near, far, _ = inside(cone_of(parameters), rays)
        return entered(near, far)

    def unlikely(self, parameters: Array) -> float:
        """Nothing is."""
        return 0.0

    def height(self, parameters: Array) -> float:
        """Of its upper rim."""
        return cone_of(parameters).height

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of a circle, larger or smaller at each height."""
        return cone_radii(parameters, heights, angles)

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return a surface of revolution."""
        _, _, low, top, h = cone_of(parameters)
        middle = (0.5 * (low + top), 0.5 * h)
        profile = np.array([(0.0, 0.0), (low, 0.0), middle, (top, h), (0.0, h)])
        return trimesh.creation.revolve(profile, sections=SECTIONS)
