"""A sample of a mesh's surface with smoothed points and normals, however noisy or coarse it is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]

POINTS = 3000
MAX_FACES = 40_000  # of these the normals are averaged
PATCH = 0.007  # m; about half of a fingertip's breadth
WALL, CLEAN = 0.2, 0.65  # of a patch's area; at an edge of a box 0.71 is left of it
MAX_EDGE = 0.008  # m; longer edges are divided


class Surface(NamedTuple):
    """Points of a surface.

    Attributes
    ----------
    points : (n, 3)
        Smoothed, in the frame of the mesh [m].
    normals : (n, 3)
        Outward unit normals of the patch round each.
    """

    points: Array
    normals: Array


def sample_surface(vertices: Array, faces: NDArray[np.int64]) -> Surface:
    """Sample a surface evenly by area, each point averaged over the patch that a fingertip covers.

    The sum of the oriented areas of a patch hangs on its border alone, so noise of the vertices
    within it cancels; faces that look the other way, such as the far side of a thin wall, are left
    out.

    Parameters
    ----------
    vertices : (v, 3), faces : (f, 3)
        The mesh, oriented outwards or inwards as a whole [m].
    """
    vertices, faces = _divide(vertices, faces)
    corners = vertices[faces]
    oriented = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    centres = corners.mean(axis=1)
    if np.einsum("fi,fi->", oriented, centres - centres.mean(axis=0)) < 0.0:
        oriented = -oriented
    area = np.linalg.norm(oriented, axis=1)
    real = area > 0.0
    centres, oriented, area = centres[real], oriented[real], area[real]
    if len(area) > MAX_FACES:
        kept = _evenly(area, MAX_FACES)
        centres, area = centres[kept], np.ones(MAX_FACES)
        oriented = oriented[kept] / np.linalg.norm(oriented[kept], axis=1, keepdims=True)
    chosen = np.unique(_evenly(area, POINTS))
    return _smooth(centres, oriented, area, chosen)


def _divide(vertices: Array, faces: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Return a mesh without long edges."""
    longest = max(MAX_EDGE, float(np.ptp(vertices[faces].reshape(-1, 3), axis=0).max()) / 60.0)
    edges = vertices[faces] - vertices[np.roll(faces, 1, axis=1)]
    if np.linalg.norm(edges, axis=2).max() <= longest:
        return vertices, faces
    divided = trimesh.remesh.subdivide_to_size(vertices, faces, longest, max_iter=20)
    return np.asarray(divided[0], dtype=np.float64), np.asarray(divided[1], dtype=np.int64)


def _evenly(area: Array, count: int) -> NDArray[np.int64]:
    """Return faces, each about as often as its area says."""
    cumulated = np.cumsum(area)
    steps = (np.arange(count) + 0.5) / count * cumulated[-1]
    found: NDArray[np.int64] = np.searchsorted(cumulated, steps).astype(np.int64)
    return found


def _smooth(centres: Array, oriented: Array, area: Array, chosen: NDArray[np.int64]) -> Surface:
    """Average positions and normals over the patch round each chosen face."""
    own = cKDTree(centres[chosen])
    pairs = own.sparse_distance_matrix(cKDTree(centres), PATCH, output_type="coo_matrix")
    i, j = pairs.row, pairs.col
    # noise folds small faces over, and only the sum of all of a patch is left of its direction;
    # what is clean has more in common, and the two sides of a thin wall less
    whole = _sums(i, oriented[j], len(chosen)) + oriented[chosen]
    total = np.bincount(i, area[j], len(chosen)) + area[chosen]
    common = np.linalg.norm(whole, axis=1) / total
    folded = (common > WALL) & (common < CLEAN)
    normals = np.where(folded[:, None], whole, oriented[chosen])
    for _ in range(2):
        same = np.einsum("pi,pi->p", normals[i], oriented[j]) > 0.0
        i, j = i[same], j[same]
        normals = _sums(i, oriented[j], len(chosen))
        lost = ~np.any(normals, axis=1)
        normals[lost] = oriented[chosen][lost]
        normals[folded] = whole[folded]
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    off = np.einsum("pi,pi->p", centres[j] - centres[chosen][i], normals[i])
    total = np.bincount(i, area[j], len(chosen)) + area[chosen]
    shift = np.bincount(i, off * area[j], len(chosen)) / total
    return Surface(centres[chosen] + shift[:, None] * normals, normals)


def _sums(rows: NDArray[np.int32], values: Array, count: int) -> Array:
    return np.stack([np.bincount(rows, column, count) for column in values.T], axis=1)
