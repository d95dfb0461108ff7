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
from igrip.perception.registration.gradual_search import Finished, GradualSearch
from igrip.perception.registration.hand_motion import HandMotion, Holders
from igrip.perception.registration.refused import Refusals
from igrip.perception.registration.search import Steps, on_object, search_steps
from igrip.perception.registration.shape import Shape, shape_of
from igrip.perception.registration.table import Table
from igrip.perception.registration.track import DepthTrack
from igrip.perception.registration.view import DepthView, depth_view, measured_points
from igrip.perception.transforms import inverse, object_pose, rigid
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import Settings, quantity

POINTS = 3000  # that a new object is fitted to in the end
MISSED = 3.0  # s for which what was visible until then is looked for before all else; guess
MISSED_INTERVAL = 0.1  # s between searches for it; guess
FEW_STARTS = 300  # models with so few of them are all sought at once where nothing is tracked


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
    search_budget: int = quantity(
        100, "1", "starts that a search tries in a frame while something is tracked; about 10 ms",
        "docs/poses.md", ge=1,
    )  # fmt: skip
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
    seen: dict[str, float] = field(default_factory=dict)  # when each was last visible [s]
    missed: GradualSearch = field(default_factory=GradualSearch)  # for what was just visible
    absent: GradualSearch = field(default_factory=GradualSearch)  # for all else
    refusals: Refusals = field(default_factory=Refusals)
    hands: HandMotion = field(default_factory=HandMotion)
    holders: Holders = field(default_factory=Holders)


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
        moving = camera.hands.update(view, hands, frame.t)
        beside = view.beside_hands()
        for id, track in list(camera.tracks.items()):
            hand = camera.holders.hand_at(id, track.fit, track.state == "visible", moving)
            updated = track.update(beside, frame.t, hand)
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
        camera.missed.stop()
        camera.absent.stop()
        camera.refusals.clear()

    def _search(
        self, camera: _CameraState, view: DepthView, frame: RgbdFrame, others: Sequence[PoseFit]
    ) -> None:
        """Look for the objects that are not visible, no longer than tracking can wait."""
        visible = {id for id, track in camera.tracks.items() if track.state == "visible"}
        camera.seen.update(dict.fromkeys(visible, frame.t))
        wanted = {id: shape for id, shape in self._shapes.items() if id not in visible}
        missed = {
            id: shape for id, shape in wanted.items()
            if 0.0 <= frame.t - camera.seen.get(id, -np.inf) < MISSED
        }  # fmt: skip
        absent = {id: shape for id, shape in wanted.items() if id not in missed}
        interval = self.options.search_interval
        for search, models, pause in (
            (camera.missed, missed, min(MISSED_INTERVAL, interval)),
            (camera.absent, absent, interval),
        ):
            elapsed = np.inf if search.begun is None else frame.t - search.begun
            if not search.busy and models and not 0.0 <= elapsed < pause:
                search.begin(self._steps(camera, view, frame, models, others), frame.t)
            first = not camera.tracks
            done = search.go_on(None if first else self.options.search_budget)
            if done is not None:
                self._take(camera, done, view, frame.t)
                if first and camera.tracks:
                    search.begun = None  # what is left is sought from the next frame on
            if search.busy:
                break  # what is missed comes first

    def _steps(
        self, camera: _CameraState, view: DepthView, frame: RgbdFrame, wanted: dict[str, Shape],
        others: Sequence[PoseFit],
    ) -> Steps:  # fmt: skip
        """Look for objects in a frame, step by step; return those that agree in the end."""
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
        known = [track.fit for track in camera.tracks.values() if track.state == "visible"]
        known += [replace(fit, pose=fit.pose.after(table_from_world)) for fit in others]
        context = SearchContext(view, score, self.options.threshold, self._random)
        few = sum(len(shape.starts) for shape in wanted.values()) <= FEW_STARTS
        found = yield from search_steps(
            table, points[:, 2], wanted, known, context, camera.refusals, frame.t,
            split=few or bool(camera.tracks),
        )  # fmt: skip
        confirmed = {}
        for id, rough in found.items():
            beside = [other for name, other in found.items() if name != id] + known
            fit = self._confirmed(rough, beside, context)
            if fit is not None:
                confirmed[id] = fit
        return confirmed

    def _take(self, camera: _CameraState, done: Finished, view: DepthView, t: float) -> None:
        """Begin to follow what a search found, if it is still there."""
        for id, fit in done.fits.items():
            visible = [track.fit for track in camera.tracks.values() if track.state == "visible"]
            if any(on_object(other, fit.centre[None])[0] for other in visible):
                continue
            track = DepthTrack(fit, done.t, fit.hidden)
            if done.t < t:
                track = track.update(view, t)
            if track.state == "visible":
                camera.tracks[id] = track
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
