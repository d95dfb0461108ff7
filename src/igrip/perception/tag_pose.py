"""Poses of what AprilTags are stuck to, from the corners of the tags in a picture.

The frame of a tag, as the AprilTag project prints it: origin at its centre, x to the right, y up,
z out of the paper.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from igrip.perception.opencv import load_opencv
from igrip.perception.tag_detector import TagDetection
from igrip.perception.transforms import rigid
from igrip.rgbd import Array, Intrinsics

MIN_CORNER_NOISE = 0.2  # pixels; docs/tags.md
SAME_POSE = math.radians(8.0)  # poses that differ by less are one; guess
DECISIVE = 12.0  # by how much the second pose must fit worse, in squared deviations; guess
MAX_RMS = 2.0  # pixels a corner may be off, root mean square; guess
MOTION_STD = math.radians(12.0)  # an object turns so far between two frames; guess
UPRIGHT_STD = math.radians(10.0)  # of upright objects and of the camera's pose; guess
CORNERS = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])
_IPPE_ORDER = [3, 2, 1, 0]  # from the upper left, clockwise


class TagPlacement(NamedTuple):
    """Where a tag is stuck."""

    size: float  # edge of its black square [m]
    object_from_tag: Array  # (4, 4)

    @property
    def corners(self) -> Array:
        """The corners, (4, 3), in the frame of the object [m]."""
        points: Array = self.size * CORNERS @ self.object_from_tag[:3, :3].T
        return points + self.object_from_tag[:3, 3]


class TagPose(NamedTuple):
    """A pose, and how well the tags agree with it."""

    camera_from_object: Array  # (4, 4)
    misfit: float  # sum of squares of what the corners are off [pixels²]
    noise: float  # standard deviation of a corner, estimated from the fit [pixels]
    covariance: Array  # (3, 3), of the object's origin, in the camera's frame [m²]

    def excess_misfit(self, other: TagPose) -> float:
        """Return by how much it fits worse, in squared deviations: twice the log of the odds."""
        return (self.misfit - other.misfit) / other.noise**2


def tag_poses(
    tags: Sequence[TagDetection], placements: Mapping[int, TagPlacement], camera: Intrinsics
) -> list[TagPose]:
    """Return the poses that explain the tags of one object, the best first.

    A square seen from afar looks the same tilted to either side: each tag has two poses (Collins &
    Bartoli 2014, IPPE). Each is refined on the corners of all tags together. Poses that are
    returned differ by more than 8°, and every tag faces the camera.
    """
    if not tags:
        return []
    points = np.vstack([placements[tag.id].corners for tag in tags])
    pixels = np.vstack([tag.corners for tag in tags])
    if not np.isfinite(pixels).all():
        return []
    cv2 = load_opencv("poses of tags")
    poses: list[TagPose] = []
    for tag in tags:
        placement = placements[tag.id]
        square = (placement.size * CORNERS)[_IPPE_ORDER]
        corners = np.ascontiguousarray(tag.corners[_IPPE_ORDER])
        count, rotations, translations, _ = cv2.solvePnPGeneric(
            square, corners, camera.matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
        )
        tag_from_object = np.linalg.inv(placement.object_from_tag)
        for k in range(count):
            camera_from_tag = rigid(cv2.Rodrigues(rotations[k])[0], translations[k].ravel())
            pose = _refine(points, pixels, camera.matrix, camera_from_tag @ tag_from_object)
            if pose is not None and _face_camera(tags, placements, pose.camera_from_object):
                poses.append(pose)
    poses.sort(key=lambda pose: pose.misfit)
    distinct: list[TagPose] = []
    for pose in poses:
        matrix, others = pose.camera_from_object, [other.camera_from_object for other in distinct]
        if all(angle_between(matrix, other) > SAME_POSE for other in others):
            distinct.append(pose)
    return [pose for pose in distinct if pose.misfit <= MAX_RMS**2 * len(pixels)]


def angle_between(one: Array, other: Array) -> float:
    """Return the angle of the rotation between two poses, (4, 4) [rad]."""
    cosine = 0.5 * (np.trace(one[:3, :3].T @ other[:3, :3]) - 1.0)
    return math.acos(min(1.0, max(-1.0, float(cosine))))


def choose_pose(
    poses: Sequence[TagPose], before: Array | None = None, up: tuple[Array, Array] | None = None
) -> tuple[TagPose, float] | None:
    """Choose among the poses of :func:`tag_poses`; return one and its probability.

    None: two poses fit alike, and nothing decides between them.

    Parameters
    ----------
    poses : sequence of TagPose
        Of the same tags.
    before : (4, 4), optional
        Camera from object a moment ago.
    up : pair of (3,), optional
        A direction in the object's frame, and the same in the camera's: the object stands upright.
    """
    if not poses:
        return None
    # in a picture without any noise two poses may both fit to a hair; corners are never so good
    odds = [-0.5 * pose.excess_misfit(poses[0]) for pose in poses]
    for k, (camera_from_object, *_) in enumerate(poses):
        if before is not None:
            odds[k] -= 0.5 * (angle_between(camera_from_object, before) / MOTION_STD) ** 2
        if up is not None:
            cosine = float(np.clip(camera_from_object[:3, :3] @ up[0] @ up[1], -1.0, 1.0))
            odds[k] -= 0.5 * (math.acos(cosine) / UPRIGHT_STD) ** 2
    order = sorted(range(len(poses)), key=lambda k: -odds[k])
    best = order[0]
    # neither the pose before nor being upright justifies a pose that the picture contradicts
    if poses[best].excess_misfit(poses[0]) > 2.0 * DECISIVE:
        return None
    if len(order) > 1 and 2.0 * (odds[best] - odds[order[1]]) < DECISIVE:
        return None
    rest = sum(math.exp(max(odds[k] - odds[best], -700.0)) for k in order[1:])
    return poses[best], 1.0 / (1.0 + rest)


def _refine(points: Array, pixels: Array, matrix: Array, start: Array) -> TagPose | None:
    cv2 = load_opencv("poses of tags")
    turn, move = cv2.Rodrigues(start[:3, :3])[0], start[:3, 3:].copy()
    turn, move = cv2.solvePnPRefineLM(points, pixels, matrix, None, turn, move)
    projected, slopes = cv2.projectPoints(points, turn, move, matrix, None)
    pose = rigid(cv2.Rodrigues(turn)[0], move.ravel())
    depths = points @ pose[2, :3] + pose[2, 3]
    if not np.isfinite(pose).all() or (depths <= 0.0).any():
        return None
    misfit = float(np.square(projected[:, 0] - pixels).sum())
    noise = max(MIN_CORNER_NOISE, math.sqrt(misfit / max(2 * len(points) - 6, 1)))
    slopes = slopes[:, :6]
    covariance = noise**2 * np.linalg.pinv(slopes.T @ slopes)
    return TagPose(pose, misfit, noise, covariance[3:, 3:])


def _face_camera(
    tags: Sequence[TagDetection], placements: Mapping[int, TagPlacement], pose: Array
) -> bool:
    """Whether every detected tag shows its front to the camera."""
    fronts = [pose @ placements[tag.id].object_from_tag for tag in tags]
    return all(float(tag[:3, 2] @ tag[:3, 3]) < 0.0 for tag in fronts)
