"""Stable poses of rigid objects on a plane: their centre of gravity can sink no more.

Why not by trimesh: docs/decisions.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]

DIRECTIONS = 4000  # about 3° apart
NEIGHBOURS = 9
SAME = np.radians(25.0)  # poses nearer than this count as one; a fit bridges the rest
SNAP = np.radians(8.0)  # a face so near to the direction found is what the object rests on


class StablePoses(NamedTuple):
    """The ways in which an object rests: as its file stands, if it can, then the likeliest first.

    Attributes
    ----------
    rotations : (k, 3, 3)
        Table-from-mesh, z of the table up; any further turn about z is as good.
    heights : (k,)
        Of the origin of the mesh over the table [m].
    probabilities : (k,)
        Share of all directions from which it comes to rest so, if it topples slowly.
    """

    rotations: Array
    heights: Array
    probabilities: Array


def stable_poses(
    vertices: Array, centre: Array, min_probability: float = 0.02, max_poses: int = 14
) -> StablePoses:
    """Find how an object can rest on a plane.

    The height of the centre of gravity over the plane is the support function of the convex hull;
    its minima over all directions are the resting poses, and their basins of descent the share of
    directions that lead to each.

    Parameters
    ----------
    vertices : (v, 3)
        Of the mesh [m].
    centre : (3,)
        Centre of gravity, in the frame of the mesh [m].
    min_probability : float
        Less likely ways are left out, unless there is no other or the mesh stands as its file does.
    max_poses : int
        That are returned.
    """
    hull = trimesh.convex.convex_hull(vertices)
    corners = np.asarray(hull.vertices) - centre
    down = _directions(DIRECTIONS)
    height = (down @ corners.T).max(axis=1)
    near = np.asarray(cKDTree(down).query(down, k=NEIGHBOURS)[1])
    lowest = near[np.arange(len(down)), np.argmin(height[near], axis=1)]
    while True:  # follow the descent to its end
        further = lowest[lowest]
        if (further == lowest).all():
            break
        lowest = further
    ends, share = np.unique(lowest, return_counts=True)
    normals = np.asarray(hull.face_normals)
    rests = normals[(normals @ corners.T).max(axis=1).argsort(kind="stable")]
    found: list[tuple[Array, float]] = []
    for k in np.lexsort((ends, height[ends])):  # the lowest first: they draw in those beside them
        direction, probability = down[ends[k]], share[k] / len(down)
        for i, (other, so_far) in enumerate(found):
            if other @ direction > np.cos(SAME):
                found[i] = (other, so_far + probability)
                break
        else:
            faces = rests[rests @ direction > np.cos(SNAP)]
            found.append((faces[0] if len(faces) else direction, probability))
    found.sort(key=lambda way: -way[1])
    # people stand objects up, however rarely these would fall that way
    found.sort(key=lambda way: way[0][2] >= -np.cos(SNAP))  # stable
    stands = found[0][0][2] < -np.cos(SNAP)
    kept = found[:1] + [way for way in found[1:] if way[1] >= min_probability]
    if not stands and len(kept) > 1 and kept[0][1] < min_probability:
        kept = kept[1:]
    kept = kept[:max_poses]
    rotations = np.array([_turn_down(direction) for direction, _ in kept])
    heights = np.array([-(vertices @ R[2]).min() for R in rotations])
    return StablePoses(rotations, heights, np.array([way[1] for way in kept]))


def _directions(count: int) -> Array:
    """Return unit vectors spread evenly over the sphere (Fibonacci lattice), shape (count, 3)."""
    k = np.arange(count)
    z = 1.0 - (2.0 * k + 1.0) / count
    angle = np.pi * (1.0 + 5.0**0.5) * k
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)


def _turn_down(direction: Array) -> Array:
    """Return the rotation that turns this direction of the mesh to the table's -z."""
    up = -direction / np.linalg.norm(direction)
    aside = np.eye(3)[np.argmin(np.abs(up))]
    if abs(up[2]) > 0.9:
        aside = np.eye(3)[0]  # what stands as its file does is not turned about the vertical
    x = aside - (aside @ up) * up
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(up, x), up])
