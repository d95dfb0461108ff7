"""Signed distance to a mesh on a grid: one look-up gives how far a point is from it, and which way.

Registration against a distance field needs no search for correspondences (Fitzgibbon 2003, Image
and Vision Computing 21:1145-1153).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.mesh.bvh import STACK, Bvh
from igrip.mesh.nearest import nearest
from igrip.mesh.ray import count_hits
from igrip.rgbd import Array

MARGIN = 0.03  # of the grid round the mesh [m]; farther out the distance to the grid is added
MAX_CELLS = 60_000  # about
MIN_CELL = 0.002  # edge of a cell [m]
# a mesh with holes is not closed: what most rays leave by an odd number of crossings is inside
RAYS = np.array([
    [0.5387, 0.3181, 0.7803], [-0.6143, 0.7517, 0.2399], [0.1733, -0.8969, 0.4069],
    [-0.3911, -0.2273, -0.8919], [0.8317, -0.1559, -0.5329],
])  # fmt: skip


class SignedDistanceField(NamedTuple):
    """Signed distances from a mesh, negative inside, in its frame."""

    values: NDArray[np.float32]  # (nx, ny, nz), at the corners of the cells [m]
    origin: Array  # (3,), of the first corner [m]
    cell: float  # edge of a cell [m]

    def distances(self, points: Array) -> Array:
        """Return the signed distances of points (n, 3) of the mesh's frame, shape (n,) [m]."""
        distances = np.empty(len(points))
        _look_up_all(self, np.ascontiguousarray(points), distances)
        return distances


def signed_distance_field(vertices: Array, bvh: Bvh) -> SignedDistanceField:
    """Return the field of a mesh with vertices (v, 3) [m], from the tree of its triangles."""
    low, high = vertices.min(axis=0) - MARGIN, vertices.max(axis=0) + MARGIN
    cell = max(MIN_CELL, float(np.prod(high - low) / MAX_CELLS) ** (1.0 / 3.0))
    shape = np.ceil((high - low) / cell).astype(int) + 1
    field = SignedDistanceField(np.empty(tuple(shape), dtype=np.float32), low, cell)
    _fill(bvh.boxes, bvh.links, bvh.leaves, RAYS, field)
    return field


@kernel
def _fill(boxes, links, leaves, rays, field):
    values, origin, cell = field
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    counters = np.zeros(3, dtype=np.int64)
    for i in range(values.shape[0]):
        for j in range(values.shape[1]):
            bound = np.inf
            for k in range(values.shape[2]):
                x, y, z = origin[0] + i * cell, origin[1] + j * cell, origin[2] + k * cell
                away, _, _, _ = nearest(
                    boxes, links, leaves, 0, 0, x, y, z, bound, stack, near_stack, counters
                )
                bound = (away + cell) ** 2 * (1.0 + 1e-9) + 1e-12  # the next corner is a step on
                odd = 0
                for w in range(rays.shape[0]):
                    odd += count_hits(
                        boxes, links, leaves, 0, 0, x, y, z,
                        rays[w, 0], rays[w, 1], rays[w, 2], stack,
                    ) % 2  # fmt: skip
                values[i, j, k] = -away if 2 * odd > rays.shape[0] else away


@kernel
def look_up(values, origin, cell, x, y, z, gradient):
    """Return the signed distance of a point of the mesh's frame [m]; write its gradient (3,).

    The field is given in its parts: a tuple of arrays costs time to pass, and loops call this.
    """
    nx, ny, nz = values.shape
    a, b, c = (x - origin[0]) / cell, (y - origin[1]) / cell, (z - origin[2]) / cell
    a0 = min(max(a, 0.0), nx - 1.000001)
    b0 = min(max(b, 0.0), ny - 1.000001)
    c0 = min(max(c, 0.0), nz - 1.000001)
    i, j, k = int(a0), int(b0), int(c0)
    u, v, w = a0 - i, b0 - j, c0 - k
    v000, v001 = values[i, j, k], values[i, j, k + 1]
    v010, v011 = values[i, j + 1, k], values[i, j + 1, k + 1]
    v100, v101 = values[i + 1, j, k], values[i + 1, j, k + 1]
    v110, v111 = values[i + 1, j + 1, k], values[i + 1, j + 1, k + 1]
    c00, c01 = v000 + u * (v100 - v000), v001 + u * (v101 - v001)
    c10, c11 = v010 + u * (v110 - v010), v011 + u * (v111 - v011)
    d0, d1 = c00 + v * (c10 - c00), c01 + v * (c11 - c01)
    gradient[0] = (
        (1 - v) * ((1 - w) * (v100 - v000) + w * (v101 - v001))
        + v * ((1 - w) * (v110 - v010) + w * (v111 - v011))
    ) / cell
    gradient[1] = ((1 - w) * (c10 - c00) + w * (c11 - c01)) / cell
    gradient[2] = (d1 - d0) / cell
    result = d0 + w * (d1 - d0)
    dx, dy, dz = (a - a0) * cell, (b - b0) * cell, (c - c0) * cell
    outside = np.sqrt(dx * dx + dy * dy + dz * dz)
    if outside > 1e-5:
        gradient[0], gradient[1], gradient[2] = dx / outside, dy / outside, dz / outside
        result += outside
    return result


@kernel
def _look_up_all(field, points, out):
    values, origin, cell = field
    g = np.empty(3)
    for n in range(points.shape[0]):
        out[n] = look_up(values, origin, cell, points[n, 0], points[n, 1], points[n, 2], g)
