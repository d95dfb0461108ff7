"""A mesh without what does not belong to it: the ground plane of a modelling program."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

FLAT = 0.02  # thickness of a plane in terms of its width
LARGER = 2.0  # times that it is wider than all that stands on it
APART = 1.0  # of the largest body's size: a gap between two bodies of one object is smaller


def without_ground_plane(loaded: Any) -> tuple[trimesh.Trimesh | None, str | None]:
    """Return all bodies of a file as one mesh, but for a ground plane, and a remark on that.

    A ground plane is a flat body apart from the others that is at least twice as wide as they are.

    Parameters
    ----------
    loaded : trimesh.Trimesh, trimesh.Scene or other
        What trimesh read.

    Returns
    -------
    trimesh.Trimesh or None
        None where there are no faces.
    str or None
        What was left out, or lies far from the rest.
    """
    mesh = loaded.to_mesh() if isinstance(loaded, trimesh.Scene) and loaded.geometry else loaded
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
        return None, None
    if not np.isfinite(mesh.vertices).all():
        return mesh, None
    groups = trimesh.graph.connected_components(
        _adjacency(mesh), nodes=np.arange(len(mesh.faces)), min_len=1
    )
    if not 2 <= len(groups) <= 1000:
        return mesh, None
    widest = max(groups, key=lambda faces: float(np.max(_extent(mesh, faces))))
    size = np.sort(_extent(mesh, widest))
    others = np.setdiff1d(np.arange(len(mesh.faces)), widest)
    rest = float(np.max(_extent(mesh, others)))
    if not (size[0] <= FLAT * size[1] and size[1] >= LARGER * rest and rest > 0.0):
        return mesh, _stray(mesh, groups)
    kept = mesh.submesh([others], append=True, repair=False)
    sizes = " × ".join(f"{value:.3g}" for value in size[::-1])
    return kept, f"a flat body of {sizes} in its units, like a ground plane, was left out"


def _stray(mesh: trimesh.Trimesh, groups: Sequence[NDArray[np.int64]]) -> str | None:
    """Return a remark on bodies that lie far from the largest one; None without any."""
    corners = [mesh.vertices[mesh.faces[faces]].reshape(-1, 3) for faces in groups]
    low, high = (np.array([bound(c, axis=0) for c in corners]) for bound in (np.min, np.max))
    largest = int(np.argmax(np.max(high - low, axis=1)))
    gaps = np.maximum(low - high[largest], low[largest] - high).max(axis=1)
    far = gaps > APART * float(np.max(high[largest] - low[largest]))
    if not far.any():
        return None
    return (
        f"{int(far.sum())} of its {len(groups)} bodies lie apart from the largest, up to "
        f"{float(gaps.max()):.3g} in its units: if they do not belong to it, delete them"
    )


def _adjacency(mesh: trimesh.Trimesh) -> NDArray[np.int64]:
    """Return pairs of faces that share a vertex in space, shape (n, 2)."""
    _, place = np.unique(np.round(mesh.vertices, 9), axis=0, return_inverse=True)
    corners = place.reshape(-1)[mesh.faces]
    order = np.argsort(corners, axis=None, kind="stable")
    vertices = corners.ravel()[order]
    faces = np.repeat(np.arange(len(mesh.faces)), 3)[order]
    same = vertices[1:] == vertices[:-1]
    return np.stack([faces[:-1][same], faces[1:][same]], axis=1)


def _extent(mesh: trimesh.Trimesh, faces: NDArray[np.int64]) -> NDArray[np.float64]:
    points = mesh.vertices[mesh.faces[faces]].reshape(-1, 3)
    extent: NDArray[np.float64] = np.ptp(points, axis=0)
    return extent
