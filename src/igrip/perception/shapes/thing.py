"""Models of things, from a segment of one view; and things that are followed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.objects.model import ObjectModel, build_model
from igrip.perception.registration.align import Resting
from igrip.perception.registration.fit import REST_WEIGHT, PoseFit, rated
from igrip.perception.registration.rigid_pose import RigidPose
from igrip.perception.registration.shape import Shape, derive_shape
from igrip.perception.registration.track import DepthTrack
from igrip.perception.registration.view import DepthView
from igrip.perception.registration.visibility import Visibility
from igrip.perception.shapes.fit_primitive import ShapeFit
from igrip.perception.shapes.look import Look, look_of
from igrip.perception.shapes.segments import Segment
from igrip.perception.shapes.surface import surface_of
from igrip.rgbd import Array

UNSEEN = Visibility(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
TOUCHES = 0.02  # m; a segment so near to a thing is a view of it


class Built(NamedTuple):
    """A thing as one view shows it."""

    mesh: trimesh.Trimesh  # frame of the table, but for ``origin`` [m]
    origin: Array  # (3,), of the mesh, on the table under its middle [m]
    fit: ShapeFit
    simple: bool  # whether the mesh is the simple shape
    look: Look


@dataclass(frozen=True, eq=False)
class Thing:
    """A thing that one camera follows."""

    track: DepthTrack
    kind: str  # of its simple shape
    born: float  # when it was first seen [s]
    built: float  # when its model was last made [s]
    hidden: float  # share of it that was hidden then
    std: float  # of its shape's middle, besides the pose's [m]


def build_thing(
    segment: Segment, fit: ShapeFit, depth: NDArray[np.float32], colour: NDArray[np.uint8],
    view: DepthView,
) -> Built:  # fmt: skip
    """Make a mesh of a segment; ``depth`` and ``colour`` are pictures, (h, w) [m], (h, w, 3)."""
    surface = surface_of(fit, segment.points, depth, view)
    pixels = colour[segment.pixels[:, 1], segment.pixels[:, 0]]
    look = look_of(np.asarray(surface.mesh.vertices), pixels)
    return Built(surface.mesh, np.append(fit.parameters[:2], 0.0), fit, surface.simple, look)


def model_of(name: str, built: Built, pose: RigidPose | None = None) -> ObjectModel:
    """Return the model of a thing; in the frame of an earlier model of it in ``pose``, if given."""
    mesh, primitive = built.mesh, built.fit.primitive
    axis = primitive.axis
    if pose is not None:
        mesh = mesh.copy()
        mesh.vertices = pose.to_mesh(np.asarray(mesh.vertices) + built.origin)
        axis = None if axis is None else axis @ pose.rotation
    symmetry = primitive.symmetry if built.simple else "none"
    model = build_model(name, mesh, symmetry, axis)
    # as of catalogue meshes that are not closed: hollow things are grasped as if they were full
    return replace(model, centre=np.asarray(mesh.convex_hull.center_mass, dtype=np.float64))


def fit_of(shape: Shape, pose: RigidPose, view: DepthView, std: float) -> PoseFit:
    """Return a thing in a pose, table-from-mesh, at rest as it stands there."""
    up = pose.rotation[2].copy()
    height = float((pose.rotation @ shape.surface.centre + pose.translation)[2])
    resting = Resting(up, height, REST_WEIGHT)
    return rated(PoseFit(shape, pose, UNSEEN, 1.0, resting, std), view)


def new_thing(shape: Shape, built: Built, view: DepthView, t: float) -> Thing:
    """Return a thing that begins to be followed at time ``t`` [s]."""
    fit = fit_of(shape, RigidPose(np.eye(3), built.origin.copy()), view, built.fit.std)
    track = DepthTrack(fit, t, fit.hidden)
    return Thing(track, built.fit.kind, t, t, fit.hidden, built.fit.std)


def with_model(thing: Thing, model: ObjectModel, view: DepthView, t: float) -> Thing:
    """Return a thing with a refined model, in the frame of the former."""
    shape = derive_shape(model)
    track = thing.track
    fit = fit_of(shape, track.fit.pose, view, track.fit.std)
    return replace(
        thing, track=replace(track, fit=fit, hidden=fit.hidden), built=t, hidden=fit.hidden
    )


def shares_place(fit: PoseFit, other: PoseFit) -> bool:
    """Whether two meshes stand in one place: most of the smaller is on or in the other."""
    small, large = sorted((fit, other), key=lambda one: one.shape.surface.radius)
    points = small.pose.apply(small.shape.surface.points)
    distances = large.shape.surface.field.distances(large.pose.to_mesh(points))
    return bool((distances < TOUCHES).mean() > 0.5)


def belongs_to(segment: Segment, fit: PoseFit) -> float:
    """Return which share of a segment's points is on or in a thing."""
    distances = fit.shape.surface.field.distances(fit.pose.to_mesh(segment.points))
    return float((distances < TOUCHES).mean())
