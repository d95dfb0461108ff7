"""``ellipsoid``: fruit that is longer than wide, lying: pears, lemons, potatoes, eggs."""

from __future__ import annotations

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays
from igrip.perception.shapes.primitives._cone import flattened
from igrip.perception.shapes.primitives.sphere import Sphere
from igrip.rgbd import Array

SHORTEST, LONGEST = 0.35, 0.95  # width over length
FLATTEST, TALLEST = 0.6, 1.3  # height over width


@PRIMITIVES.register("ellipsoid")
class Ellipsoid:
    """Parameters: x, y, logarithm of half its length, width over length, height over width, yaw."""

    symmetry: Symmetry = "box"
    axis = None
    cost = 0.03  # its length along the line of sight is hardly seen
    steps = np.array([0.008, 0.008, 0.12, -0.12, 0.1, 0.3])
    wall = None

    def __init__(self) -> None:
        self._round = Sphere()

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        longer, shorter = np.maximum(footprint.half, 0.005)
        slim = np.clip(shorter / longer, SHORTEST, 0.8)
        high = np.clip(0.5 * footprint.height / (slim * longer), FLATTEST, TALLEST)
        return np.array([*footprint.middle, np.log(longer), slim, high, footprint.yaw])

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Those of a sphere, in a frame where it is one."""
        x, y, half, slim, height, yaw = _sizes(parameters)
        turned = flattened(rays, x, y, yaw, slim)
        stretch = np.array([1.0, 1.0, half / (0.5 * height)])
        ball = Rays(turned.origin * stretch, turned.directions * stretch)
        return self._round.depths(np.array([0.0, 0.0, np.log(half), 0.0]), ball)

    def unlikely(self, parameters: Array) -> float:
        """Nothing is."""
        return 0.0

    def height(self, parameters: Array) -> float:
        """Of its highest point."""
        return _sizes(parameters)[4]

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of an ellipse at each height."""
        _, _, half, slim, height, yaw = _sizes(parameters)
        across = half * np.sqrt(np.maximum(1.0 - (2.0 * heights / height - 1.0) ** 2, 0.0))
        turned = angles - yaw
        round_one = 1.0 / np.hypot(np.cos(turned), np.sin(turned) / slim)
        return np.asarray(across[:, None] * round_one[None, :])

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return an icosphere, stretched and turned."""
        _, _, half, slim, height, yaw = _sizes(parameters)
        mesh = trimesh.creation.icosphere(subdivisions=3, radius=half)
        mesh.apply_scale((1.0, slim, 0.5 * height / half))
        mesh.apply_transform(trimesh.transformations.rotation_matrix(yaw, (0, 0, 1)))
        mesh.apply_translation((0.0, 0.0, 0.5 * height))
        return mesh


def _sizes(parameters: Array) -> tuple[float, float, float, float, float, float]:
    """Return x, y, half length, width over length, height and yaw."""
    x, y, half, slim, high, yaw = parameters.tolist()
    long = float(np.exp(half))
    slim = float(np.clip(slim, SHORTEST, LONGEST))
    return x, y, long, slim, 2.0 * long * slim * float(np.clip(high, FLATTEST, TALLEST)), yaw
