"""The trees of several meshes as the kernel reads them: one after the other in the same arrays."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.mesh.bvh import Bvh
from igrip.mesh.inscribed_spheres import BALLS
from igrip.objects.model import ObjectModel

Array = NDArray[np.float64]


class PackedModels(NamedTuple):
    """Several meshes; replaced as a whole when one is added.

    Attributes
    ----------
    models, number : dict
        The models by name, and the number of each in what follows.
    bvh, vertices : Bvh
        Trees of their triangles and of their vertices.
    starts, spheres, balls, axes, origins : arrays
        As :func:`igrip.geometry.kernel.measure` reads them.
    half_lengths : (m,)
        Of their bounding cylinders [m].
    sizes : (m, 2)
        Half-lengths and radii of these [m].
    """

    models: dict[str, ObjectModel]
    number: dict[str, int]
    bvh: Bvh
    vertices: Bvh
    starts: NDArray[np.int64]
    spheres: Array
    balls: Array
    axes: Array
    origins: Array
    half_lengths: Array
    sizes: Array


def pack(models: dict[str, ObjectModel]) -> PackedModels:
    """Put the trees of models one after the other."""
    bvh, triangle_starts = _joined((model.bvh for model in models.values()), 9)
    vertices, vertex_starts = _joined((model.vertex_tree for model in models.values()), 3)
    frames = [model.mesh_from_object[:3, :3] for model in models.values()]
    return PackedModels(
        models=models,
        number={name: number for number, name in enumerate(models)},
        bvh=bvh,
        vertices=vertices,
        starts=np.concatenate([triangle_starts, vertex_starts], axis=1),
        spheres=np.array([model.sphere for model in models.values()]).reshape(-1, 4),
        balls=np.array([model.balls for model in models.values()]).reshape(-1, BALLS, 4),
        axes=np.array(frames).reshape(-1, 3, 3),
        origins=np.array([model.origin for model in models.values()]).reshape(-1, 3),
        half_lengths=np.array([0.5 * model.length for model in models.values()]),
        sizes=np.array([(0.5 * m.length, m.radius) for m in models.values()]).reshape(-1, 2),
    )


def _joined(trees: Iterable[Bvh], width: int) -> tuple[Bvh, NDArray[np.int64]]:
    """Return one tree of many roots, and the first node and leaf of each, shape (m, 2)."""
    empty = Bvh(np.empty((0, 12), np.float32), np.empty((0, 2), np.int32), np.empty((0, width)))
    parts = [empty, *trees]
    sizes = np.array([[len(tree.boxes), len(tree.leaves)] for tree in parts], dtype=np.int64)
    together = Bvh(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))
    return together, np.cumsum(sizes, axis=0)[:-1]
