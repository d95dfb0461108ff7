"""``box``: stands or lies on a face."""

from __future__ import annotations

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays, entered, slab
from igrip.rgbd import Array


@PRIMITIVES.register("box")
class Box:
    """Parameters: x, y, yaw, and the logarithms of half its length, half its width, its height."""

    symmetry: Symmetry = "box"
    axis = None
    cost = 0.012
    steps = np.array([0.008, 0.008, 0.2, 0.12, 0.12, 0.06])
    wall = None

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        sizes = np.log([*np.maximum(footprint.half, 0.005), footprint.height])
        return np.array([*footprint.middle, footprint.yaw, *sizes])

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Slabs (Kay & Kajiya 1986), in the frame of the box."""
        x, y, yaw = parameters[:3]
        a, b, h = np.exp(parameters[3:])
        c, s = np.cos(yaw), np.sin(yaw)
        ox, oy = rays.origin[0] - x, rays.origin[1] - y
        dx, dy, dz = rays.directions.T
        near, far = np.full(len(dx), -np.inf), np.full(len(dx), np.inf)
        slab(near, far, c * ox + s * oy, c * dx + s * dy, a)
        slab(near, far, c * oy - s * ox, c * dy - s * dx, b)
        slab(near, far, rays.origin[2] - 0.5 * h, dz, 0.5 * h)
        return entered(near, far)

    def unlikely(self, parameters: Array) -> float:
        """Nothing is."""
        return 0.0

    def height(self, parameters: Array) -> float:
        """Of its upper face."""
        return float(np.exp(parameters[5]))

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of a rectangle, the same at each height."""
        a, b = np.exp(parameters[3:5])
        turned = angles - parameters[2]
        across = np.maximum(np.abs(np.cos(turned)) / a, np.abs(np.sin(turned)) / b)
        return np.tile(1.0 / across, (len(heights), 1))

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Twelve triangles."""
        a, b, h = np.exp(parameters[3:])
        mesh = trimesh.creation.box((2.0 * a, 2.0 * b, h))
        mesh.apply_transform(trimesh.transformations.rotation_matrix(parameters[2], (0, 0, 1)))
        mesh.apply_translation((0.0, 0.0, 0.5 * h))
        return mesh
