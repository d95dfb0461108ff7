"""``depth``: poses from depth alone, on a CPU: table, clusters, registration, then tracking.

How it works, and what was measured: docs/poses.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pydantic import Field

from igrip.entities import ObjectPose
from igrip.errors import IgripError
from igrip.objects.catalog import Catalog
from igrip.perception.options import validated
from igrip.perception.poses import POSES
from igrip.perception.registration.colours import (
    Palette,
    colour_similarity,
    palette_of,
    read_picture,
)
from igrip.perception.registration.crop import points_near
from igrip.perception.registration.fit import PoseFit, SearchContext, misfit, refit_flipped
from igrip.perception.registration.search import find_objects, on_object
from igrip.perception.registration.shape import Shape, shape_of
from igrip.perception.registration.table import Table
from igrip.perception.registration.track import DepthTrack
from igrip.perception.registration.view import DepthView, depth_view, measured_points
from igrip.perception.transforms import inverse, object_pose, rigid
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import Settings, quantity

POINTS = 3000  # that a new object is fitted to in the end


class DepthOptions(Settings):
    """The options of the pose estimator ``depth``.

    Attributes
    ----------
    models : list of str or None
        Names in the catalogue to look for; None: all of them.
    instances : dict of str to int
        How many there may be of a model, where not one. The first has the model's name as its id,
        the others ``NAME#2``, ``NAME#3`` and so on.
    colours : dict of str to str
        Pictures of models, cropped to the object: what is found must have such colours.
    """

    models: tuple[str, ...] | None = None
    instances: dict[str, int] = Field(default_factory=dict)
    colours: dict[str, str] = Field(default_factory=dict)
    threshold: float = quantity(
        0.66, "1", "fits with a lesser score are no object", "docs/poses.md", ge=0, le=1
    )
    max_misfit: float = quantity(
        0.045, "1", "mean square of how far an object's points are off, in shares of what noise "
        "allows", "docs/poses.md", gt=0,
    )  # fmt: skip
    min_depth: float = quantity(0.2, "m", "of what is looked at", "guess", ge=0)
    max_depth: float = quantity(2.0, "m", "of what is looked at", "guess", gt=0)
    search_interval: float = quantity(
        0.5, "s", "between searches for objects that are not visible", "guess", ge=0
    )
    tolerance: float = quantity(
        0.004, "m", "by which meshes and cameras err, besides noise", "guess", gt=0
    )
    stride: int = quantity(2, "pixels", "between the points of a search", "docs/poses.md", ge=1)
    seed: int = quantity(0, "1", "of the random choices", "", ge=0)


@dataclass(eq=False)
class _CameraState:
    """What is remembered of one camera."""

    table: Table = field(default_factory=Table)
    tracks: dict[str, DepthTrack] = field(default_factory=dict)
    gone: set[str] = field(default_factory=set)
    searched: float | None = None  # when objects were last looked for [s]


@POSES.register("depth")
class DepthPoses:
    """A :class:`igrip.perception.poses.PoseEstimator` that registers meshes to depth.

    ``options`` are the fields of :class:`DepthOptions`.

    Raises
    ------
    IgripError
        If an option is unknown or wrong, or a picture cannot be read.
    UnknownModelError
        If the catalogue lacks a model that is named.
    """

    def __init__(self, catalog: Catalog, options: Mapping[str, Any] | None = None) -> None:
        self.options = validated(DepthOptions, "depth", options or {})
        names = catalog if self.options.models is None else self.options.models
        self._shapes: dict[str, Shape] = {}
        for name in names:
            shape = shape_of(catalog[name])
            self._shapes[name] = shape
            for number in range(2, self.options.instances.get(name, 1) + 1):
                self._shapes[f"{name}#{number}"] = shape
        self._palettes: dict[str, Palette] = {
            catalog[name].name: palette_of(read_picture(path))
            for name, path in self.options.colours.items()
        }
        self._reach = (self.options.min_depth, self.options.max_depth)
        self._cameras: dict[str, _CameraState] = {}
        self._random = np.random.default_rng(self.options.seed)

    def estimate(
        self, frame: RgbdFrame, hands: Sequence[Array] = (), others: Sequence[PoseFit] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Return the pose of each object; see :class:`igrip.perception.poses.PoseEstimator`.

        ``others`` are things that are none of them, world-from-mesh: no object is sought there.

        Raises
        ------
        IgripError
            If the frame has no depth.
        """
        if frame.depth is None:
            raise IgripError("the pose estimator 'depth' needs a camera with depth; or use 'tags'")
        camera = self._cameras.setdefault(frame.camera, _CameraState())
        seen = any(track.state == "visible" for track in camera.tracks.values())
        if not camera.table.update(frame, self._reach, self._random, seen):
            return _poses(camera)
        assert camera.table.plane is not None
        if camera.table.change is not None:
            self._carry_on(camera, camera.table.change)
        view = depth_view(frame, hands, camera.table.plane, self.options.tolerance)
        for id, track in list(camera.tracks.items()):
            updated = track.update(view, frame.t)
            if updated.state == "gone":
                del camera.tracks[id]
                camera.gone.add(id)
            else:
                camera.tracks[id] = updated
        self._search(camera, view, frame, others)
        return _poses(camera)

    def close(self) -> None:
        """Forget all cameras."""
        self._cameras.clear()

    def visible_fits(self, camera: str) -> list[PoseFit]:
        """Return the objects that a camera saw in its newest frame; poses are world-from-mesh."""
        state = self._cameras.get(camera)
        if state is None:
            return []
        world = state.table.world_from_table
        return [
            replace(track.fit, pose=track.fit.pose.after(world))
            for track in state.tracks.values() if track.state == "visible"
        ]  # fmt: skip

    def _carry_on(self, camera: _CameraState, change: Array) -> None:
        """Move tracks into the frame of a table that was found anew."""
        for id, track in camera.tracks.items():
            moved = replace(track.fit, pose=track.fit.pose.after(change))
            camera.tracks[id] = replace(track, fit=moved)
        camera.searched = None

    def _search(
        self, camera: _CameraState, view: DepthView, frame: RgbdFrame, others: Sequence[PoseFit]
    ) -> None:
        """Look for the objects that are not visible, if it is time to."""
        visible = {id: track for id, track in camera.tracks.items() if track.state == "visible"}
        wanted = {id: shape for id, shape in self._shapes.items() if id not in visible}
        elapsed = np.inf if camera.searched is None else frame.t - camera.searched
        if not wanted or 0.0 <= elapsed < self.options.search_interval:
            return
        camera.searched = frame.t
        points, pixels = measured_points(
            view.depth, view.intrinsics, self.options.stride, self._reach
        )
        points = points[view.mask[pixels[:, 1], pixels[:, 0]] == 0]
        table = points @ view.table_from_camera[:3, :3].T + view.table_from_camera[:3, 3]

        def score(fit: PoseFit) -> float:
            palette = self._palettes.get(fit.shape.name)
            if palette is None:
                return fit.score
            return fit.score * colour_similarity(fit, view, frame.colour, palette)

        table_from_world = inverse(camera.table.world_from_table)
        known = [track.fit for track in visible.values()]
        known += [replace(fit, pose=fit.pose.after(table_from_world)) for fit in others]
        context = SearchContext(view, score, self.options.threshold, self._random)
        found = find_objects(table, points[:, 2], wanted, known, context)
        for id, rough in found.items():
            beside = [other for name, other in found.items() if name != id] + known
            fit = self._confirmed(rough, beside, context)
            if fit is not None:
                camera.tracks[id] = DepthTrack(fit, frame.t, fit.hidden)
                camera.gone.discard(id)

    def _confirmed(
        self, rough: PoseFit, others: list[PoseFit], context: SearchContext
    ) -> PoseFit | None:
        """Fit to all points of an object; return None if they agree too little."""
        view = context.view
        near, depths = points_near(view, rough.pose, rough.shape.surface, POINTS)
        own = np.ones(len(near), dtype=np.bool_)
        for other in others:  # what stands beside it is no evidence against it
            own &= ~on_object(other, near)
        if not own.any():
            return None
        fit = refit_flipped(rough, near[own], depths[own], view)
        if context.score(fit) < 0.9 * context.threshold:
            return None
        # above it is something alike, but not the same
        return fit if misfit(fit, near[own], view) <= self.options.max_misfit else None


def _poses(camera: _CameraState) -> dict[str, ObjectPose | None]:
    poses: dict[str, ObjectPose | None] = dict.fromkeys(camera.gone)
    for id, track in camera.tracks.items():
        fit = track.fit
        poses[id] = object_pose(
            rigid(*fit.pose.after(camera.table.world_from_table)), model=fit.shape.name, t=track.t,
            std=fit.std, score=min(1.0, fit.score), source="depth",
        )  # fmt: skip
    return poses
