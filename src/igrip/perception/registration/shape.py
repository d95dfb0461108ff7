"""What registration needs of a model beyond its mesh, derived once and kept on disk."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.compiled import cache_directory
from igrip.objects.array_cache import read_arrays, sources_digest, write_arrays
from igrip.objects.model import ObjectModel
from igrip.objects.stable_poses import StablePoses, stable_poses
from igrip.perception.registration.distinct_starts import TURNS, distinct_starts
from igrip.perception.registration.signed_distance import SignedDistanceField, signed_distance_field
from igrip.rgbd import Array

MAX_POINTS = 400  # on a surface; those too near to another are left out
_DERIVED_BY = (
    "perception/registration/shape.py", "perception/registration/signed_distance.py",
    "perception/registration/distinct_starts.py", "objects/stable_poses.py",
)  # fmt: skip


class Surface(NamedTuple):
    """A mesh as kernels use it; lengths in metres, in its own frame.

    An argument of functions with ``@kernel``: the cache of compiled code notices an edit here.
    """

    field: SignedDistanceField
    points: Array  # (n, 3), spread evenly over the surface
    normals: Array  # (n, 3), outward unit normals there
    centre: Array  # (3,), of its bounding sphere
    radius: float  # of the sphere


class Shape(NamedTuple):
    """A model as registration uses it."""

    name: str
    surface: Surface
    stable_poses: StablePoses
    axes: Array  # (3, 3), of the object frame, as columns
    starts: NDArray[np.int64]  # (k, 2), ways of resting and turns that a search tries


def shape_of(model: ObjectModel) -> Shape:
    """Derive the shape of a model, or read it from the cache."""
    digest = hashlib.sha256(sources_digest(_DERIVED_BY).encode())
    for array in (model.vertices, model.faces, model.centre, model.mesh_from_object):
        digest.update(np.ascontiguousarray(array).tobytes())
    path = cache_directory() / "shapes" / f"{digest.hexdigest()[:32]}.npz"
    shape = _read(path, model)
    if shape is None:
        shape = derive_shape(model)
        points, centre, field = shape.surface.points[::2], shape.surface.centre, shape.surface.field
        starts = distinct_starts(points, centre, field, shape.stable_poses)
        shape = shape._replace(starts=starts)
        _write(path, shape)
    return shape


def derive_shape(model: ObjectModel) -> Shape:
    """Derive the shape of a model; nothing is kept on disk, and all starts count as distinct."""
    mesh = trimesh.Trimesh(model.vertices, model.faces, process=False)
    points, faces = trimesh.sample.sample_surface_even(mesh, MAX_POINTS, seed=0)
    surface = Surface(
        signed_distance_field(model.vertices, model.bvh), np.asarray(points),
        np.asarray(mesh.face_normals[faces]), model.sphere[:3].copy(), float(model.sphere[3]),
    )  # fmt: skip
    ways = stable_poses(model.vertices, model.centre)
    starts = np.array(list(np.ndindex(len(ways.heights), len(TURNS))), dtype=np.int64)
    return Shape(model.name, surface, ways, model.mesh_from_object[:3, :3].copy(), starts)


def _read(path: Path, model: ObjectModel) -> Shape | None:
    stored = read_arrays(path)
    if stored is None:
        return None
    try:
        field = SignedDistanceField(stored["values"], stored["origin"], float(stored["cell"]))
        return Shape(
            model.name,
            Surface(
                field, stored["points"], stored["normals"], stored["centre"],
                float(stored["radius"]),
            ),
            StablePoses(stored["rotations"], stored["heights"], stored["probabilities"]),
            stored["axes"], stored["starts"],
        )  # fmt: skip
    except (KeyError, TypeError):
        return None  # it is derived again


def _write(path: Path, shape: Shape) -> None:
    arrays = {
        **shape.surface._asdict(), **shape.surface.field._asdict(),
        **shape.stable_poses._asdict(), "axes": shape.axes, "starts": shape.starts,
    }  # fmt: skip
    del arrays["field"]
    write_arrays(path, arrays)
