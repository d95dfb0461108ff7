"""The surface of a body as a mesh: one vertex in each cell that the surface passes through.

Naive surface nets (Gibson 1998, MICCAI: 888-898).
"""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.perception.scan.fuse import Body
from igrip.rgbd import Array

CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
EDGES = [
    (a, b) for a in range(8) for b in range(a + 1, 8)
    if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1
]  # fmt: skip


def mesh_of(body: Body) -> trimesh.Trimesh:
    """Return the surface of a body, closed, its normals outward, in the frame of the object [m]."""
    values = body.values
    shape = tuple(n - 1 for n in values.shape)
    corners = [values[i : i + shape[0], j : j + shape[1], k : k + shape[2]] for i, j, k in CORNERS]
    inside = np.stack([corner < 0.0 for corner in corners])
    crossed = inside.any(axis=0) & ~inside.all(axis=0)
    cells = np.argwhere(crossed)
    at = np.stack([corner[crossed] for corner in corners], axis=1)
    offsets, counts = np.zeros((len(cells), 3)), np.zeros(len(cells))
    for a, b in EDGES:
        cut = (at[:, a] < 0.0) != (at[:, b] < 0.0)
        share = at[cut, a] / (at[cut, a] - at[cut, b])
        offsets[cut] += CORNERS[a] + share[:, None] * (CORNERS[b] - CORNERS[a])
        counts[cut] += 1.0
    vertices = body.origin + body.cell * (cells + offsets / counts[:, None])
    number = np.full(shape, -1, dtype=np.int64)
    number[tuple(cells.T)] = np.arange(len(cells))
    faces = np.concatenate([_faces_across(values, number, axis) for axis in range(3)])
    return trimesh.Trimesh(vertices, faces, process=False)


def _faces_across(values: Array, number: NDArray[np.int64], axis: int) -> NDArray[np.int64]:
    """Return the triangles, (m, 3), across edges of the grid along one axis."""
    n = values.shape
    here = [slice(1, n[k] - 1) for k in range(3)]
    here[axis] = slice(0, n[axis] - 1)
    beyond = list(here)
    beyond[axis] = slice(1, n[axis])
    first, second = values[tuple(here)] < 0.0, values[tuple(beyond)] < 0.0
    edges = np.argwhere(first != second) + [0 if k == axis else 1 for k in range(3)]
    outward = first[first != second]  # the body ends along the axis
    b, c = (axis + 1) % 3, (axis + 2) % 3
    quad = []
    for back_b, back_c in ((1, 1), (0, 1), (0, 0), (1, 0)):
        cell = edges.copy()
        cell[:, b] -= back_b
        cell[:, c] -= back_c
        quad.append(number[tuple(cell.T)])
    corners = np.stack(quad, axis=1)
    corners = np.where(outward[:, None], corners, corners[:, ::-1])
    return np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
