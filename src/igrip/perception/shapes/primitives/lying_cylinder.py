"""``lying_cylinder``: a can or a bottle on its side, a banana, a pen."""

from __future__ import annotations

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays, entered, slab
from igrip.rgbd import Array

SECTIONS = 36


@PRIMITIVES.register("lying_cylinder")
class LyingCylinder:
    """Parameters: x, y, yaw of its axis, logarithms of half its length and of its radius."""

    symmetry: Symmetry = "cylinder"
    axis = None
    cost = 0.012
    steps = np.array([0.008, 0.008, 0.2, 0.12, 0.08])
    wall = None

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        sizes = np.log([max(footprint.half[0], 0.005), max(0.5 * footprint.height, 0.004)])
        return np.array([*footprint.middle, footprint.yaw, *sizes])

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Where rays enter a tube between two planes."""
        half, r = np.exp(parameters[3:])
        c, s = np.cos(parameters[2]), np.sin(parameters[2])
        ox, oy = rays.origin[0] - parameters[0], rays.origin[1] - parameters[1]
        dx, dy, dz = rays.directions.T
        v, w = c * oy - s * ox, rays.origin[2] - r
        dv = c * dy - s * dx
        a, b, g = dv**2 + dz**2, v * dv + w * dz, v**2 + w**2 - r**2
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(b * b - a * g)
            near, far = (-b - root) / a, (-b + root) / a
        near, far = np.nan_to_num(near, nan=np.inf), np.nan_to_num(far, nan=-np.inf)
        slab(near, far, c * ox + s * oy, c * dx + s * dy, half)
        return entered(near, far)

    def unlikely(self, parameters: Array) -> float:
        """Nothing is."""
        return 0.0

    def height(self, parameters: Array) -> float:
        """Its diameter."""
        return 2.0 * float(np.exp(parameters[4]))

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of a rectangle, widest half way up."""
        half, r = np.exp(parameters[3:])
        width = np.sqrt(np.maximum(r**2 - (heights - r) ** 2, 1e-12))[:, None]
        turned = angles - parameters[2]
        along, across = np.abs(np.cos(turned)) / half, np.abs(np.sin(turned))[None, :] / width
        return np.asarray(1.0 / np.maximum(along[None, :], across))

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return a tube with caps."""
        half, r = np.exp(parameters[3:])
        mesh = trimesh.creation.cylinder(r, 2.0 * half, sections=SECTIONS)
        turn = trimesh.transformations.rotation_matrix
        mesh.apply_transform(turn(0.5 * np.pi, (0, 1, 0)))
        mesh.apply_transform(turn(parameters[2], (0, 0, 1)))
        mesh.apply_translation((0.0, 0.0, r))
        return mesh
