"""Points, vectors and distances in the frame of a mesh."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel


@kernel
def to_mesh(rotation, translation, p, out):
    """Write a point of the world in the frame of a mesh with this world-from-mesh pose."""
    x, y, z = p[0] - translation[0], p[1] - translation[1], p[2] - translation[2]
    for axis in range(3):
        out[axis] = rotation[0, axis] * x + rotation[1, axis] * y + rotation[2, axis] * z


@kernel
def turn_to_mesh(rotation, v, out):
    """Write a vector of the world in the frame of a mesh."""
    for axis in range(3):
        out[axis] = rotation[0, axis] * v[0] + rotation[1, axis] * v[1] + rotation[2, axis] * v[2]


@kernel
def distance(p, q):
    """Return how far two points are apart."""
    return np.sqrt((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2 + (q[2] - p[2]) ** 2)


@kernel
def distance2(p, x, y, z):
    """Return a squared distance, with room for the rounding of another way to compute it."""
    return ((x - p[0]) ** 2 + (y - p[1]) ** 2 + (z - p[2]) ** 2) * (1.0 + 1e-12) + 1e-300
