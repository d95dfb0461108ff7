"""The same object from another file: noisy, turned, with fewer faces."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from igrip.taxonomy import GRIP_TYPES

NEAR, ANGLE, OPENING = 0.08, np.cos(np.radians(40.0)), 0.02  # as one may slide along a box


def noisy(mesh, rng, size=0.002):
    """Move every vertex by a normal step of this length (root of the mean square)."""
    noise = rng.normal(0.0, size / np.sqrt(3.0), mesh.vertices.shape)
    return trimesh.Trimesh(mesh.vertices + noise, mesh.faces, process=False)


def turned(mesh, rng):
    """Return a mesh in another frame, and the rotation and translation to it."""
    rotation, translation = Rotation.random(rng=rng).as_matrix(), rng.normal(0.0, 0.1, 3)
    moved = mesh.vertices @ rotation.T + translation
    return trimesh.Trimesh(moved, mesh.faces, process=False), rotation, translation


def decimated(mesh, size=0.005):
    """Join all vertices within each cell of a grid."""
    cells = np.floor(mesh.vertices / size).astype(int)
    _, which = np.unique(cells, axis=0, return_inverse=True)
    which = which.ravel()
    count = np.bincount(which)
    places = np.stack([np.bincount(which, axis) / count for axis in mesh.vertices.T], axis=1)
    faces = which[mesh.faces]
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return trimesh.Trimesh(places, faces[whole], process=False)


def brought_back(candidates, rotation, translation):
    """Return candidates in the frame before it was turned."""
    return [
        c._replace(
            point=rotation.T @ (c.point - translation), pivot=rotation.T @ (c.pivot - translation),
            approach=rotation.T @ c.approach, closing=rotation.T @ c.closing,
            axis=rotation.T @ c.axis,
        )
        for c in candidates
    ]  # fmt: skip


def found_again(candidates, others, least=0.1):
    """Return how many of the candidates of at least this prior others have too, and of how many."""
    main = [c for c in candidates if c.weight >= least]
    return sum(any(is_same(a, b) for b in others) for a in main), len(main)


def is_same(a, b):
    """Whether two candidates differ by little, turned towards one another."""
    a = a.turned(a.turn_towards(b))
    b = b.turned(b.turn_towards(a))
    return (
        GRIP_TYPES[a.grip].family == GRIP_TYPES[b.grip].family
        and np.linalg.norm(a.point - b.point) < NEAR
        and a.approach @ b.approach > ANGLE
        and abs(a.closing @ b.closing) > ANGLE
        and abs(a.opening - b.opening) < OPENING
    )
