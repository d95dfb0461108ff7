"""Spheres inside a closed mesh: a ray that passes through one meets the mesh in any case.

A ray leads to infinity, which is outside; so from a point inside a closed surface it crosses the
surface at least once. Most rays that meet an object pass through its middle, and for those a few
spheres spare the search of the tree.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.mesh.bvh import STACK, Bvh
from igrip.mesh.nearest import nearest
from igrip.mesh.ray import count_hits

Array = NDArray[np.float64]

MAX_SPHERES = 8
GRID = 12  # points along each edge of the box at which a centre is tried
MIN_RADIUS_FRACTION = 0.15  # of the radius of the first: smaller spheres decide too few rays
# three directions that no edge of an object made by hand is likely to lie along; all have to agree
DIRECTIONS = np.array(
    [[0.5387, 0.3181, 0.7803], [-0.6143, 0.7517, 0.2399], [0.1733, -0.8969, 0.4069]]
)


def is_closed(vertices: Array, faces: NDArray[np.int64]) -> bool:
    """Return whether every edge belongs to an even number of faces: the surface has no border."""
    _, same = np.unique(vertices, axis=0, return_inverse=True)  # seams of textures are no border
    corners = same.reshape(-1)[faces]
    edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, count = np.unique(edges, axis=0, return_counts=True)
    return bool((count % 2 == 0).all())


def inscribed_spheres(vertices: Array, faces: NDArray[np.int64], bvh: Bvh) -> Array:
    """Find spheres inside a mesh, the largest first.

    Parameters
    ----------
    vertices : (v, 3), faces : (f, 3)
        The mesh [m].
    bvh : Bvh
        Tree of its triangles.

    Returns
    -------
    (8, 4)
        Centre and radius [m]. A radius of -1: no sphere, as in all rows of a mesh that is not
        closed.
    """
    spheres = np.full((MAX_SPHERES, 4), -1.0)
    if not is_closed(vertices, faces):
        return spheres
    low, high = bvh.leaves.reshape(-1, 3).min(axis=0), bvh.leaves.reshape(-1, 3).max(axis=0)
    steps = (np.arange(GRID) + 0.5) / GRID
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    points = low + grid * (high - low)
    depth = np.empty(len(points))
    _depth(bvh.boxes, bvh.links, bvh.leaves, points, DIRECTIONS, depth)
    for k in range(MAX_SPHERES):
        deepest = int(np.argmax(depth))
        radius = depth[deepest] * (1.0 - 1e-6)
        if not radius > max(1e-6, MIN_RADIUS_FRACTION * spheres[0, 3]):
            break
        spheres[k] = *points[deepest], radius
        # the next one should lie where this one is not
        depth[np.linalg.norm(points - points[deepest], axis=1) < radius] = 0.0
    return spheres


@kernel
def _depth(boxes, links, leaves, points, directions, depth):
    """Write the distance of each point to the surface [m]; 0 for points that are not inside."""
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    counters = np.zeros(3, dtype=np.int64)
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        depth[i] = 0.0
        inside = True
        for w in range(directions.shape[0]):
            hits = count_hits(
                boxes, links, leaves, 0, 0, x, y, z,
                directions[w, 0], directions[w, 1], directions[w, 2], stack,
            )  # fmt: skip
            inside = inside and hits % 2 == 1
        if inside:
            depth[i], _, _, _ = nearest(
                boxes, links, leaves, 0, 0, x, y, z, np.inf, stack, near_stack, counters
            )
