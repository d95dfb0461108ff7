"""Meshes as the kernels read them: the trees of all, one after the other in the same arrays."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.mesh.bvh import Bvh
from igrip.mesh.inscribed_spheres import MAX_SPHERES
from igrip.objects.model import ObjectModel

Array = NDArray[np.float64]


class ModelArrays(NamedTuple):
    """Several meshes, each in its own frame; kernels find one by its number.

    Attributes
    ----------
    boxes, links, triangles : arrays
        Trees of their triangles, as a :class:`igrip.mesh.bvh.Bvh`.
    vertex_boxes, vertex_links, vertices : arrays
        Trees of their vertices, likewise.
    starts : (m, 4) int64
        First node and first triangle, first node and first vertex of each.
    spheres : (m, 4)
        Bounding sphere of each, centre and radius [m].
    inscribed_spheres : (m, 8, 4)
        Spheres inside each, centre and radius [m]; a negative radius: none.
    axes, origins : (m, 3, 3), (m, 3)
        Object axes by columns, and origin of the object frame [m].
    sizes : (m, 2)
        Half-length and radius of the bounding cylinder of each [m].
    """

    boxes: NDArray[np.float32]
    links: NDArray[np.int32]
    triangles: Array
    vertex_boxes: NDArray[np.float32]
    vertex_links: NDArray[np.int32]
    vertices: Array
    starts: NDArray[np.int64]
    spheres: Array
    inscribed_spheres: Array
    axes: Array
    origins: Array
    sizes: Array


class PackedModels(NamedTuple):
    """Several meshes; replaced as a whole when one is added.

    Attributes
    ----------
    models, number : dict
        The models by name, and the number of each in the arrays.
    arrays : ModelArrays
        For the kernels.
    """

    models: dict[str, ObjectModel]
    number: dict[str, int]
    arrays: ModelArrays


def pack(models: dict[str, ObjectModel]) -> PackedModels:
    """Put the trees of models one after the other."""
    every = list(models.values())
    bvh, triangle_starts = _joined((model.bvh for model in every), 9)
    vertices, vertex_starts = _joined((model.vertex_tree for model in every), 3)
    arrays = ModelArrays(
        *bvh,
        *vertices,
        starts=np.concatenate([triangle_starts, vertex_starts], axis=1),
        spheres=np.array([m.sphere for m in every]).reshape(-1, 4),
        inscribed_spheres=np.array([m.inscribed_spheres for m in every]).reshape(
            -1, MAX_SPHERES, 4
        ),
        axes=np.array([m.mesh_from_object[:3, :3] for m in every]).reshape(-1, 3, 3),
        origins=np.array([m.origin for m in every]).reshape(-1, 3),
        sizes=np.array([(0.5 * m.length, m.radius) for m in every]).reshape(-1, 2),
    )
    return PackedModels(models, {name: number for number, name in enumerate(models)}, arrays)


def _joined(trees: Iterable[Bvh], width: int) -> tuple[Bvh, NDArray[np.int64]]:
    """Return one tree of many roots, and the first node and leaf of each, shape (m, 2)."""
    empty = Bvh(np.empty((0, 12), np.float32), np.empty((0, 2), np.int32), np.empty((0, width)))
    parts = [empty, *trees]
    sizes = np.array([[len(tree.boxes), len(tree.leaves)] for tree in parts], dtype=np.int64)
    together = Bvh(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))
    return together, np.cumsum(sizes, axis=0)[:-1]
