"""``sphere``: fruit and balls."""

from __future__ import annotations

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays, entered
from igrip.rgbd import Array


@PRIMITIVES.register("sphere")
class Sphere:
    """Parameters: x, y, and the logarithm of its radius; flatter or taller by a fourth."""

    symmetry: Symmetry = "cylinder"
    axis = np.array([0.0, 0.0, 1.0])
    cost = 0.008
    steps = np.array([0.008, 0.008, 0.12, 0.05])
    wall = None

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        return np.array([*footprint.middle, np.log(max(0.5 * footprint.height, 0.005)), 0.0])

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Where rays enter; the vertical is stretched until it is round."""
        radius, flat = self._sizes(parameters)
        stretch = np.array([1.0, 1.0, 1.0 / flat])
        o = (rays.origin - (parameters[0], parameters[1], radius * flat)) * stretch
        d = rays.directions * stretch
        a, b, c = (d * d).sum(axis=1), d @ o, float(o @ o) - radius**2
        with np.errstate(invalid="ignore"):
            root = np.nan_to_num(np.sqrt(b * b - a * c), nan=-1.0)
        return np.where(root >= 0.0, entered((-b - root) / a, (-b + root) / a), np.inf)

    def unlikely(self, parameters: Array) -> float:
        """By how flat or tall it is; guess."""
        return 0.01 * float((parameters[3] / 0.1) ** 2)

    def height(self, parameters: Array) -> float:
        """Of its highest point."""
        radius, flat = self._sizes(parameters)
        return 2.0 * radius * flat

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of a circle at each height."""
        radius, flat = self._sizes(parameters)
        across = radius * np.sqrt(np.maximum(1.0 - (heights / (radius * flat) - 1.0) ** 2, 0.0))
        return np.repeat(across[:, None], len(angles), axis=1)

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return an icosphere, stretched."""
        radius, flat = self._sizes(parameters)
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=radius)
        mesh.apply_scale((1.0, 1.0, flat))
        mesh.apply_translation((0.0, 0.0, radius * flat))
        return mesh

    def _sizes(self, parameters: Array) -> tuple[float, float]:
        return float(np.exp(parameters[2])), float(np.exp(np.clip(parameters[3], -0.2, 0.2)))
