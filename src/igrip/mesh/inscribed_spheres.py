"""Balls inside a closed mesh: a ray that passes through one meets the mesh, whatever its triangles.

A ray leads to infinity, which is outside; so from a point inside a closed surface it crosses the
surface at least once. Most rays that meet an object pass through its middle, and for those a few
balls decide what a walk down the tree would.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.mesh.bvh import STACK, Bvh
from igrip.mesh.nearest import nearest
from igrip.mesh.ray import count_hits

Array = NDArray[np.float64]

BALLS = 8
GRID = 12  # points along each edge of the box at which a ball is tried
SMALLEST = 0.15  # of the radius of the first: smaller balls decide too few rays
# three ways out that no edge of an object made by hand is likely to lie along; all have to agree
WAYS = np.array([[0.5387, 0.3181, 0.7803], [-0.6143, 0.7517, 0.2399], [0.1733, -0.8969, 0.4069]])


def is_closed(vertices: Array, faces: NDArray[np.int64]) -> bool:
    """Whether every edge belongs to an even number of faces: the surface has no border."""
    _, same = np.unique(vertices, axis=0, return_inverse=True)  # seams of textures are no border
    corners = same.reshape(-1)[faces]
    edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, count = np.unique(edges, axis=0, return_counts=True)
    return bool((count % 2 == 0).all())


def inscribed_spheres(vertices: Array, faces: NDArray[np.int64], bvh: Bvh) -> Array:
    """Find balls inside a mesh, the largest first.

    Parameters
    ----------
    vertices : (v, 3), faces : (f, 3)
        The mesh [m].
    bvh : Bvh
        Tree of its triangles.

    Returns
    -------
    (8, 4)
        Centre and radius [m]. A radius of -1: no such ball, as for all of a mesh that is not
        closed.
    """
    balls = np.full((BALLS, 4), -1.0)
    if not is_closed(vertices, faces):
        return balls
    low, high = bvh.leaves.reshape(-1, 3).min(axis=0), bvh.leaves.reshape(-1, 3).max(axis=0)
    steps = (np.arange(GRID) + 0.5) / GRID
    grid = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    points = low + grid * (high - low)
    room = np.empty(len(points))
    _room(bvh.boxes, bvh.links, bvh.leaves, points, WAYS, room)
    for k in range(BALLS):
        best = int(np.argmax(room))
        radius = room[best] * (1.0 - 1e-6)
        if not radius > max(1e-6, SMALLEST * balls[0, 3]):
            break
        balls[k] = *points[best], radius
        # the next one should lie where this one is not
        room[np.linalg.norm(points - points[best], axis=1) < radius] = 0.0
    return balls


@kernel
def _room(boxes, links, leaves, points, ways, room):
    """Write how far each point is from the surface [m]; 0 for points that are not inside."""
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    counters = np.zeros(3, dtype=np.int64)
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        room[i] = 0.0
        inside = True
        for w in range(ways.shape[0]):
            hits = count_hits(
                boxes, links, leaves, 0, 0, x, y, z, ways[w, 0], ways[w, 1], ways[w, 2], stack
            )
            inside = inside and hits % 2 == 1
        if inside:
            room[i], _, _, _ = nearest(
                boxes, links, leaves, 0, 0, x, y, z, np.inf, stack, near_stack, counters
            )
