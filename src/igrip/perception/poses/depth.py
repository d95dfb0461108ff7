"""``depth``: poses from depth alone, on a CPU: table, clusters, registration, then tracking.

docs/poses.md tells how it works and what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose
from igrip.errors import IgripError
from igrip.objects.catalog import Catalog
from igrip.perception.poses import POSES, PoseEstimator
from igrip.perception.registration.colours import Palette, likeness, palette_of, read_picture
from igrip.perception.registration.fit import Fit, misfit, settled
from igrip.perception.registration.plane import Plane, find_plane
from igrip.perception.registration.search import on_shape, search
from igrip.perception.registration.shape import Shape, shape_of
from igrip.perception.registration.track import Track, follow, nearby
from igrip.perception.registration.view import View, inverse, points_of, view_of
from igrip.rgbd import RgbdFrame
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]

DENSE = 3000  # points that a new object is fitted to in the end


class DepthOptions(Settings):
    """What ``options`` of the pose finder ``depth`` may hold.

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
    misfit: float = quantity(
        0.045, "1", "nor are those whose points are farther off: mean square, in shares of what "
        "noise allows", "docs/poses.md", gt=0,
    )  # fmt: skip
    nearest: float = quantity(0.2, "m", "nothing nearer is looked at", "guess", ge=0)
    farthest: float = quantity(2.0, "m", "and nothing farther", "guess", gt=0)
    every: float = quantity(
        0.5, "s", "so often objects that are not in sight are looked for anew", "guess", ge=0
    )
    base: float = quantity(
        0.004, "m", "meshes and cameras err by this, besides noise", "guess", gt=0
    )
    stride: int = quantity(2, "pixels", "between the points of a search", "docs/poses.md", ge=1)
    seed: int = quantity(0, "1", "of the random choices", "", ge=0)


@dataclass(eq=False)
class _Camera:
    """What is remembered of one camera."""

    plane: Plane | None = None
    world_from_table: Array = field(default_factory=lambda: np.eye(4))
    tracks: dict[str, Track] = field(default_factory=dict)
    lost: set[str] = field(default_factory=set)
    searched: float | None = None


@POSES.register("depth")
def _depth(catalog: Catalog, options: Mapping[str, Any]) -> PoseEstimator:
    return DepthPoses(catalog, options)


class DepthPoses:
    """A :class:`igrip.perception.poses.PoseEstimator` that registers meshes to depth.

    Parameters
    ----------
    catalog : Catalog
        Meshes.
    options : mapping
        See :class:`DepthOptions`.

    Raises
    ------
    IgripError
        If an option is unknown or wrong, or a picture cannot be read.
    UnknownModelError
        If the catalogue lacks a model that is named.
    """

    def __init__(self, catalog: Catalog, options: Mapping[str, Any] | None = None) -> None:
        try:
            self.options = DepthOptions(**(options or {}))
        except ValidationError as error:
            first = error.errors()[0]
            name = ".".join(str(part) for part in first["loc"])
            raise IgripError(f"pose finder 'depth': option {name}: {first['msg']}") from error
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
        self._cameras: dict[str, _Camera] = {}
        self._random = np.random.default_rng(self.options.seed)

    def find(
        self, frame: RgbdFrame, hands: Sequence[Array] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Return the pose of each object; see :class:`igrip.perception.poses.PoseEstimator`.

        Raises
        ------
        IgripError
            If the frame has no depth.
        """
        if frame.depth is None:
            raise IgripError("the pose finder 'depth' needs a camera with depth; or use 'tags'")
        camera = self._cameras.setdefault(frame.camera, _Camera())
        if not self._sees_table(camera, frame):
            return self._poses(camera)
        assert camera.plane is not None
        view = view_of(frame, hands, camera.plane, self.options.base)
        for id, track in list(camera.tracks.items()):
            moved = follow(track, view, frame.t)
            if moved.state == "gone":
                del camera.tracks[id]
                camera.lost.add(id)
            else:
                camera.tracks[id] = moved
        self._search(camera, view, frame)
        return self._poses(camera)

    def close(self) -> None:
        """Forget all cameras."""
        self._cameras.clear()

    def _sees_table(self, camera: _Camera, frame: RgbdFrame) -> bool:
        """Keep the table, or find it anew if it is not where it was; whether there is one."""
        assert frame.depth is not None
        reach = (self.options.nearest, self.options.farthest)
        if camera.plane is not None:
            table_from_camera = inverse(camera.world_from_table) @ frame.world_from_camera
            camera.plane = camera.plane._replace(table_from_camera=table_from_camera)
            points, _ = points_of(frame.depth, frame.intrinsics, 16, reach)
            heights = points @ table_from_camera[2, :3] + table_from_camera[2, 3]
            near = np.maximum(0.01, 4.0 * camera.plane.spread * points[:, 2] ** 2)
            if len(points) and (np.abs(heights) < near).mean() > 0.4 * camera.plane.share:
                return True
            if any(track.state == "seen" for track in camera.tracks.values()):
                return True  # something large hides the table
        points, _ = points_of(frame.depth, frame.intrinsics, 4, reach)
        plane = find_plane(points, self._random)
        if plane is None:
            return camera.plane is not None
        before = inverse(camera.world_from_table)
        camera.plane = plane
        camera.world_from_table = frame.world_from_camera @ inverse(plane.table_from_camera)
        change = inverse(camera.world_from_table) @ inverse(before)
        camera.tracks = {id: _carried(track, change) for id, track in camera.tracks.items()}
        camera.searched = None
        return True

    def _search(self, camera: _Camera, view: View, frame: RgbdFrame) -> None:
        """Look for what is not in sight, if it is time to."""
        seen = {id: track for id, track in camera.tracks.items() if track.state == "seen"}
        wanted = {id: shape for id, shape in self._shapes.items() if id not in seen}
        due = camera.searched is None or not (0.0 <= frame.t - camera.searched < self.options.every)
        if not wanted or not due:
            return
        camera.searched = frame.t
        reach = (self.options.nearest, self.options.farthest)
        points, pixels = points_of(view.depth, view.intrinsics, self.options.stride, reach)
        open_ = view.mask[pixels[:, 1], pixels[:, 0]] == 0
        points = points[open_]
        table = points @ view.table_from_camera[:3, :3].T + view.table_from_camera[:3, 3]

        def weigh(fit: Fit) -> float:
            palette = self._palettes.get(fit.shape.name)
            if palette is None:
                return fit.score
            return fit.score * likeness(fit, view, frame.colour, palette)

        found = search(
            table, points[:, 2], wanted, [track.fit for track in seen.values()], view,
            self.options.threshold, weigh, self._random,
        )  # fmt: skip
        for id, rough in found.items():
            others = [other for name, other in found.items() if name != id]
            others += [track.fit for track in seen.values()]
            near, depths = nearby(rough, view, DENSE)
            own = np.ones(len(near), dtype=np.bool_)
            for other in others:  # what stands beside it says nothing against it
                own &= ~on_shape(other, near)
            if not own.any():
                continue
            fit = settled(rough, near[own], depths[own], view)
            if weigh(fit) < 0.9 * self.options.threshold:
                continue
            if misfit(fit, near[own], view) > self.options.misfit:
                continue  # alike, but not the same
            camera.tracks[id] = Track(fit, frame.t, fit.hidden)
            camera.lost.discard(id)

    def _poses(self, camera: _Camera) -> dict[str, ObjectPose | None]:
        poses: dict[str, ObjectPose | None] = dict.fromkeys(camera.lost)
        for id, track in camera.tracks.items():
            fit = track.fit
            pose = camera.world_from_table
            x, y, z = pose[:3, :3] @ fit.translation + pose[:3, 3]
            quaternion = Rotation.from_matrix(pose[:3, :3] @ fit.rotation).as_quat()
            poses[id] = ObjectPose(
                position=(x, y, z), orientation=tuple(quaternion.tolist()), model=fit.shape.name,
                t=track.t, std=fit.std, score=min(1.0, fit.score), source="depth",
            )  # fmt: skip
        return poses


def _carried(track: Track, change: Array) -> Track:
    """Return a track in the frame of a table that was found anew."""
    fit = track.fit
    moved = replace(
        fit, rotation=change[:3, :3] @ fit.rotation,
        translation=change[:3, :3] @ fit.translation + change[:3, 3],
    )  # fmt: skip
    return replace(track, fit=moved)
