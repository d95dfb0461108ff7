"""Objects by AprilTags stuck to them: poses from colour alone.

A flipped pose is worse than none: where one small tag is seen from afar and nothing decides between
its two poses, the object keeps its last pose and that pose's time.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose, Vector
from igrip.errors import IgripError
from igrip.objects.catalog import Catalog
from igrip.perception.poses import POSES
from igrip.perception.tag_detector import TagDetection, TagDetector
from igrip.perception.tag_options import PlacedTag, TagSearch, read_tag_options
from igrip.perception.tag_pose import TagPlacement, TagPose, choose_pose, tag_poses
from igrip.perception.transforms import object_pose, rigid
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import quantity

MISSING = (
    "the pose estimator needs to know which tags are on what: option tags = "
    '{7: {"model": "006_mustard_bottle", "size": 0.03, "position": …, "orientation": …}}'
    ", or the path of a TOML file with tables [tags.7]"
)
NEARER = 0.03  # m: what is so much nearer than a tag hides it; guess


class TagOptions(PlacedTag):
    """One tag on an object; ``position`` and ``orientation`` are in the mesh's own frame.

    Attributes
    ----------
    model : str
        Of the catalogue.
    id : str or None
        Of the object; by default the model's name.
    upright : bool
        The object stands upright whenever its tag is visible: this decides between two poses.
    """

    model: str
    id: str | None = None
    upright: bool = False


class TagsOptions(TagSearch):
    """The options of the pose estimator ``tags``.

    Attributes
    ----------
    models : tuple of str or None
        Only these models are looked for.
    up : 3 floats
        Up in the world; counts for objects that are ``upright``.
    """

    tags: Mapping[int, TagOptions]
    models: tuple[str, ...] | None = None
    up: Vector = (0.0, 0.0, 1.0)
    missing_after: float = quantity(
        1.0, "s", "without its tags in plain view, after which an object is gone", "guess", gt=0
    )


class _LastPose(NamedTuple):
    """Where an object was when its tags were last detected, as a matrix and as a message."""

    world_from_object: Array
    t: float
    message: ObjectPose


@POSES.register("tags")
class TagPoses:
    """Poses of tagged objects.

    ``options`` are the fields of :class:`TagsOptions`; ``tags`` may be the path of a TOML file,
    whose other keys are options, too.

    Raises
    ------
    IgripError
        If the options cannot be read or contradict each other.
    UnknownModelError
        If a tag is on a model that the catalogue does not have.
    MissingExtraError
        If pupil-apriltags or OpenCV is not installed.
    """

    def __init__(self, catalog: Catalog, options: Mapping[str, Any]) -> None:
        self._options = read_tag_options(TagsOptions, "tags", options, MISSING)
        self._placements: dict[str, dict[int, TagPlacement]] = defaultdict(dict)
        self._models: dict[str, str] = {}
        self._upright: dict[str, bool] = {}
        wanted = self._options.models
        for number, tag in self._options.tags.items():
            catalog[tag.model]
            if wanted is not None and tag.model not in wanted:
                continue
            id = tag.id or tag.model
            if self._models.setdefault(id, tag.model) != tag.model:
                raise IgripError(f"tag {number}: {id!r} is of two models")
            self._upright[id] = self._upright.get(id, False) or tag.upright
            pose = rigid(Rotation.from_quat(tag.orientation).as_matrix(), tag.position)
            self._placements[id][number] = TagPlacement(tag.size, pose)
        self._detector = TagDetector(self._options.family, self._options.decimate)
        self._last: dict[tuple[str, str], _LastPose] = {}  # by camera and object

    def estimate(
        self, frame: RgbdFrame, hands: Sequence[Array] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Return the pose of each tagged object; see :class:`igrip.perception.poses.PoseEstimator`.

        ``score`` is the probability that the pose is not the flipped one.
        """
        detections = {tag.id: tag for tag in self._detector.detect(frame)}
        poses: dict[str, ObjectPose | None] = {}
        for id, placements in self._placements.items():
            key = (frame.camera, id)
            last = self._last.get(key)
            if last is not None and frame.t < last.t:  # another run
                del self._last[key]
                last = None
            tags = [detections[number] for number in placements if number in detections]
            chosen = self._choose(frame, id, tags, last)
            if chosen is not None:
                last = self._last[key] = self._last_pose(frame, id, *chosen)
            if last is None:
                continue
            poses[id] = last.message
            gone = not tags and frame.t - last.t > self._options.missing_after
            if gone and self._in_plain_view(frame, placements, last, hands):
                poses[id] = None
                del self._last[key]
        return poses

    def close(self) -> None:
        """Forget all poses."""
        self._last.clear()

    def _choose(
        self, frame: RgbdFrame, id: str, tags: list[TagDetection], last: _LastPose | None
    ) -> tuple[TagPose, float] | None:
        camera_from_world = np.linalg.inv(frame.world_from_camera)
        before = up = None
        if last is not None and frame.t - last.t <= self._options.max_pose_age:
            before = camera_from_world @ last.world_from_object
        # without a calibrated pose of the camera, up is unknown
        if self._upright[id] and not np.array_equal(frame.world_from_camera, np.eye(4)):
            up = np.array([0.0, 0.0, 1.0]), camera_from_world[:3, :3] @ self._options.up
        return choose_pose(tag_poses(tags, self._placements[id], frame.intrinsics), before, up)

    def _last_pose(self, frame: RgbdFrame, id: str, pose: TagPose, probability: float) -> _LastPose:
        world_from_object = frame.world_from_camera @ pose.camera_from_object
        rotation = frame.world_from_camera[:3, :3]
        std = tuple(np.sqrt(np.diag(rotation @ pose.covariance @ rotation.T)).tolist())
        message = object_pose(
            world_from_object, model=self._models[id], t=frame.t, std=std, score=probability,
            source="tags",
        )  # fmt: skip
        return _LastPose(world_from_object, frame.t, message)

    def _in_plain_view(
        self, frame: RgbdFrame, placements: Mapping[int, TagPlacement], last: _LastPose,
        hands: Sequence[Array],
    ) -> bool:  # fmt: skip
        """Whether a tag would be visible if the object still were where it was."""
        pose = np.linalg.inv(frame.world_from_camera) @ last.world_from_object
        height, width = frame.colour.shape[:2]
        for placement in placements.values():
            tag = pose @ placement.object_from_tag
            at = tag[:3, 3]
            if at[2] <= 0.0 or tag[:3, 2] @ at > -0.5 * float(np.linalg.norm(at)):
                continue  # it faces away, or nearly
            corners = placement.corners @ pose[:3, :3].T + pose[:3, 3]
            pixels = frame.intrinsics.pixels(corners)
            if (pixels < 0).any() or (pixels >= [width, height]).any():
                continue
            margin = float(np.ptp(pixels, axis=0).max())
            if margin < 20.0 or any(_beside(pixels, hand, margin) for hand in hands):
                continue
            if frame.depth is not None:
                u, v = np.round(pixels.mean(axis=0)).astype(int)
                if 0.0 < frame.depth[v, u] < at[2] - NEARER:
                    continue
            return True
        return False


def _beside(pixels: Array, hand: Array, margin: float) -> bool:
    """Whether a hand, (21, 2), may cover corners, (4, 2): its box, grown, meets theirs."""
    low, high = hand.min(axis=0) - margin, hand.max(axis=0) + margin
    return bool((pixels.max(axis=0) >= low).all() and (pixels.min(axis=0) <= high).all())
