"""Meshes made by formula: ten primitives, and five with handles or holes."""

from __future__ import annotations

import numpy as np
import trimesh
from trimesh import creation


def _fine(mesh):
    fine = mesh.subdivide_to_size(0.005)
    fine.merge_vertices()  # noise must not tear the surface
    return fine


def _at(mesh, x=0.0, y=0.0, z=0.0, turn=None):
    if turn is not None:
        mesh.apply_transform(trimesh.transformations.rotation_matrix(*turn))
    mesh.apply_translation([x, y, z])
    return mesh


def _revolved(profile):
    return _fine(creation.revolve(np.array(profile), sections=48))


def _mug():
    # a wall with a bottom, and a handle whose ends are in the wall
    cup = _revolved([[0, 0], [0.04, 0], [0.04, 0.1], [0.036, 0.1], [0.036, 0.005], [0, 0.005]])
    handle = creation.torus(0.03, 0.006, major_sections=48, minor_sections=16)
    handle = _at(handle, 0.045, 0.0, 0.05, (np.pi / 2, [1, 0, 0]))
    keep = np.linalg.norm(handle.triangles_center[:, :2], axis=1) > 0.038
    handle.update_faces(keep)
    return trimesh.util.concatenate([cup, _fine(handle)])


def _bucket():
    cup = _revolved([[0, 0], [0.05, 0], [0.05, 0.12], [0.047, 0.12], [0.047, 0.004], [0, 0.004]])
    bow = creation.torus(0.05, 0.006, major_sections=64, minor_sections=16)
    bow = _at(bow, 0.0, 0.0, 0.12, (np.pi / 2, [1, 0, 0]))
    bow.update_faces(bow.triangles_center[:, 2] > 0.12)
    return trimesh.util.concatenate([cup, _fine(bow)])


PRIMITIVES = {
    "box": lambda: _fine(creation.box([0.07, 0.16, 0.21])),
    "cube": lambda: _fine(creation.box([0.06, 0.06, 0.06])),
    "bar": lambda: _fine(creation.box([0.03, 0.03, 0.20])),
    "plank": lambda: _fine(creation.box([0.20, 0.12, 0.008])),
    "can": lambda: _fine(creation.cylinder(0.033, 0.10, sections=48)),
    "rod": lambda: _fine(creation.cylinder(0.012, 0.20, sections=32)),
    "tin": lambda: _fine(creation.cylinder(0.045, 0.035, sections=48)),
    "ball": lambda: creation.icosphere(4, 0.036),
    "bead": lambda: creation.icosphere(4, 0.015),
    "capsule": lambda: _fine(creation.capsule(0.12, 0.03)),
}
OPEN_SHAPES = {
    "mug": _mug,
    "bucket": _bucket,
    "ring": lambda: _fine(creation.torus(0.04, 0.009, major_sections=64, minor_sections=24)),
    "tube": lambda: _fine(creation.annulus(0.028, 0.034, 0.15, sections=48)),
    "washer": lambda: _fine(creation.annulus(0.02, 0.06, 0.008, sections=64)),
}
SHAPES = PRIMITIVES | OPEN_SHAPES
BOTTLE = [[0, 0], [0.035, 0], [0.035, 0.13], [0.014, 0.16], [0.014, 0.21], [0, 0.21]]


def bottle():
    """Return a bottle with a long neck, 21 cm high, 7 and 2.8 cm thick."""
    return _revolved(BOTTLE)
