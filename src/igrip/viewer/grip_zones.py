"""The mesh of an object cut at the borders of its grip zones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from trimesh.intersections import slice_faces_plane

from igrip.grips.cylinder import is_pinch
from igrip.objects.model import ObjectModel

Array = NDArray[np.float64]
PALMAR, PINCH = (90, 130, 216), (211, 90, 192)  # the colours of the grips: red, green, blue


class Zones(NamedTuple):
    """A mesh in the object frame, with every face in one zone."""

    vertices: Array  # (v, 3), in the object frame [m]
    faces: NDArray[np.int64]  # (f, 3)
    pinch: NDArray[np.bool_]  # (f,), whether a hand beside the face pinches


def grip_zones(model: ObjectModel, pinch_from: float) -> Zones:
    """Cut a model at ±``pinch_from`` half-lengths of its cylinder."""
    frame, half = model.mesh_from_object, 0.5 * model.length
    local = (model.vertices - frame[:3, 3]) @ frame[:3, :3]
    border = pinch_from * half
    up = np.array([0.0, 0.0, 1.0])
    parts = [
        _above(*_above(local, model.faces, up, -border), -up, -border),  # between the borders
        _above(local, model.faces, up, border),
        _above(local, model.faces, -up, border),
    ]
    counts = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    vertices = np.concatenate([vertices for vertices, _ in parts])
    faces = np.concatenate([faces + n for (_, faces), n in zip(parts, counts, strict=False)])
    heights = vertices[faces][:, :, 2].mean(axis=1)
    return Zones(vertices, faces, is_pinch(heights, np.full(len(faces), half), pinch_from))


def _above(
    vertices: Array, faces: NDArray[np.int64], normal: Array, height: float
) -> tuple[Array, NDArray[np.int64]]:
    """Return the part of a mesh beyond a height along a normal."""
    if not len(faces):
        return vertices, faces
    kept, cut, _ = slice_faces_plane(vertices, faces, normal, height * normal)
    return np.asarray(kept, dtype=np.float64), np.asarray(cut, dtype=np.int64).reshape(-1, 3)
