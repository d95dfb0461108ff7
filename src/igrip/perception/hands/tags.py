"""``tags``: hands by AprilTags on a wristband, a glove or an orthosis, from colour alone.

A tag says whose hand it is, and where the palm is from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.entities import Hand, Vector
from igrip.errors import IgripError
from igrip.perception.hands import HANDS, HandDetection
from igrip.perception.tag_detector import TagDetection, TagDetector
from igrip.perception.tag_options import PlacedTag, TagSearch, read_tag_options
from igrip.perception.tag_pose import TagPlacement, TagPose, choose_pose, tag_poses
from igrip.perception.transforms import inverse, rigid
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import quantity

MISSING = (
    "which tags are on which hand? --hand-option tags=FILE.toml with tables [tags.7]: "
    'hand = "right", size = 0.03, palm = [0.0, 0.07, -0.03]'
)
TURN = math.radians(3.0)  # by which a tag's normal may be off, seen face on; guess


class HandTag(PlacedTag):
    """One tag on a hand or its arm.

    Attributes
    ----------
    hand : str
        ``right`` or ``left``.
    palm : 3 floats
        The palm's centre in the frame of the tag: origin at its centre, x to the right, y up, z out
        of it [m]. If several tags are on one hand, ``position`` and ``orientation`` place each in a
        frame that they share, and ``palm`` is in that.
    """

    hand: Literal["right", "left"]
    palm: Vector = (0.0, 0.0, 0.0)


class HandTagsOptions(TagSearch):
    """The options of the hand detector ``tags``."""

    tags: Mapping[int, HandTag]
    fit: float = quantity(
        0.008, "m", "by which a band slips and an offset is measured wrongly", "guess", gt=0
    )


class _LastPose(NamedTuple):
    """Where the tags of a hand were when they were last decided."""

    world_from_tags: Array  # (4, 4)
    t: float


@HANDS.register("tags")
class TagHands:
    """Hands that wear tags.

    ``options`` are the fields of :class:`HandTagsOptions`; ``tags`` may be the path of a TOML file,
    whose other keys are options, too.

    Raises
    ------
    IgripError
        If the options cannot be read or contradict each other.
    MissingExtraError
        If pupil-apriltags or OpenCV is not installed.
    """

    def __init__(self, options: Mapping[str, Any] | None = None) -> None:
        self._options = read_tag_options(HandTagsOptions, "hands tags", options or {}, MISSING)
        self._placements: dict[str, dict[int, TagPlacement]] = {}
        self._palms: dict[str, Array] = {}
        for number, tag in self._options.tags.items():
            pose = rigid(Rotation.from_quat(tag.orientation).as_matrix(), tag.position)
            self._placements.setdefault(tag.hand, {})[number] = TagPlacement(tag.size, pose)
            palm = self._palms.setdefault(tag.hand, np.array(tag.palm))
            if not np.array_equal(palm, tag.palm):
                raise IgripError(
                    f"hands tags: tags.{number}.palm: the tags of the {tag.hand} hand share a "
                    "frame, in which the palm is at one place"
                )
        self._detector = TagDetector(self._options.family, self._options.decimate)
        self._last: dict[tuple[str, str], _LastPose] = {}  # by camera and hand

    def detect(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands whose tags are seen; those whose tags are ambiguous are left out."""
        detections = {tag.id: tag for tag in self._detector.detect(frame)}
        found = []
        for hand, placements in self._placements.items():
            tags = [detections[number] for number in placements if number in detections]
            chosen = self._choose(frame, hand, tags)
            if chosen is not None:
                found.append(self._detection(frame, hand, tags, *chosen))
        return sorted(found, key=lambda hand: -hand.score)

    def close(self) -> None:
        """Forget all poses."""
        self._last.clear()

    def _choose(
        self, frame: RgbdFrame, hand: str, tags: list[TagDetection]
    ) -> tuple[TagPose, float, float] | None:
        """Return the pose of a hand's tags, its probability, and what is unsure of the palm [m].

        Where two poses fit alike but put the palm at nearly one place, the better one will do.
        """
        poses = tag_poses(tags, self._placements[hand], frame.intrinsics)
        if not poses:
            return None
        key = (frame.camera, hand)
        last = self._last.get(key)
        before = None
        if last is not None and 0.0 <= frame.t - last.t <= self._options.max_pose_age:
            before = inverse(frame.world_from_camera) @ last.world_from_tags
        chosen = choose_pose(poses, before)
        if chosen is not None:
            world_from_tags = frame.world_from_camera @ chosen[0].camera_from_object
            self._last[key] = _LastPose(world_from_tags, frame.t)
            return *chosen, 0.0
        palms = [self._palm(hand, pose) for pose in poses[:2]]
        apart = float(np.linalg.norm(palms[0] - palms[-1]))
        if apart > 2.0 * self._options.fit:
            return None
        return poses[0], 0.5, 0.5 * apart

    def _palm(self, hand: str, pose: TagPose) -> Array:
        there: Array = pose.camera_from_object[:3, :3] @ self._palms[hand]
        return there + pose.camera_from_object[:3, 3]

    def _detection(
        self, frame: RgbdFrame, hand: str, tags: list[TagDetection], pose: TagPose,
        probability: float, unsure: float,
    ) -> HandDetection:  # fmt: skip
        palm = self._palm(hand, pose)
        lever = TURN * float(np.linalg.norm(self._palms[hand]))
        extra = (self._options.fit**2 + lever**2 + unsure**2) * np.eye(3)
        rotation = frame.world_from_camera[:3, :3]
        covariance = rotation @ (pose.covariance + extra) @ rotation.T
        a, b, c = np.sqrt(np.diag(covariance)).tolist()
        x, y, z = (rotation @ palm + frame.world_from_camera[:3, 3]).tolist()
        measured = Hand(position=(x, y, z), t=frame.t, std=(a, b, c), score=probability,
                        source=f"{frame.camera} tags")  # fmt: skip
        pixel = frame.intrinsics.pixels(palm[None])
        points = np.vstack([pixel, *(tag.corners for tag in tags)])
        return HandDetection(points, probability, hand, measured)
