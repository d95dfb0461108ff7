"""AprilTags in pictures: their corners, and the pose of what they are stuck to.

The frame of a tag, as the AprilTag library prints it: origin at its centre, x to the right, y up,
z out of the paper. (OpenCV draws tags of the same family upside down.)
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.errors import MissingExtraError, UnknownNameError
from igrip.rgbd import Intrinsics, RgbdFrame

Array = NDArray[np.float64]

FAMILIES = ("tag16h5", "tag25h9", "tag36h11", "tagStandard41h12", "tagStandard52h13")
MIN_MARGIN = 20.0  # how surely the bits of a tag are read, 0 to about 150; guess
CORNER_NOISE = 0.2  # pixels, at least; docs/tags.md
ALIKE = math.radians(8.0)  # two poses that differ by less are one; guess
DECIDED = 12.0  # by how much the second pose must be worse, in squared deviations; guess
WORST = 2.0  # pixels a corner may be off, root mean square; guess
CORNERS = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])
_IPPE_ORDER = [3, 2, 1, 0]  # from the upper left, clockwise


class TagSeen(NamedTuple):
    """One tag in a picture.

    Attributes
    ----------
    id : int
        Its number in the family.
    corners : (4, 2)
        Lower left, lower right, upper right, upper left of its black square [pixels].
    """

    id: int
    corners: Array


class TagPlace(NamedTuple):
    """Where a tag is stuck.

    Attributes
    ----------
    size : float
        Edge of its black square [m].
    thing_from_tag : (4, 4)
        Pose of the tag in the frame of the object or board.
    """

    size: float
    thing_from_tag: Array

    @property
    def corners(self) -> Array:
        """The corners, (4, 3), in the frame of the thing [m]."""
        points: Array = self.size * CORNERS @ self.thing_from_tag[:3, :3].T
        return points + self.thing_from_tag[:3, 3]


class TagPose(NamedTuple):
    """How well tags agree with a pose.

    Attributes
    ----------
    pose : (4, 4)
        Camera from thing.
    misfit : float
        Sum of squares of what the corners are off [pixels²].
    noise : float
        Standard deviation of a corner, as far as can be told [pixels].
    covariance : (3, 3)
        Of the thing's origin, in the camera's frame [m²].
    """

    pose: Array
    misfit: float
    noise: float
    covariance: Array

    def worse_than(self, other: TagPose) -> float:
        """Return by how much it fits worse, in squared deviations: twice the log of the odds."""
        return (self.misfit - other.misfit) / other.noise**2


class TagDetector:
    """Finds the tags of one family.

    Parameters
    ----------
    family : str
        ``tag36h11`` or another of AprilTag 3.
    decimate : float
        Quads are looked for in a picture so many times smaller; corners are refined in full.

    Raises
    ------
    MissingExtraError
        If pupil-apriltags is not installed.
    UnknownNameError
        If there is no such family.
    """

    def __init__(self, family: str = "tag36h11", decimate: float = 2.0) -> None:
        try:
            import cv2
            import pupil_apriltags
        except ImportError as error:
            package = "opencv-python-headless" if error.name == "cv2" else "pupil-apriltags"
            raise MissingExtraError(package, "poses", "finding tags") from None

        class Detector(pupil_apriltags.Detector):  # type: ignore[misc]
            """Freed in the right order: pupil-apriltags frees what its detector still uses."""

            def __del__(self) -> None:
                pointer: Any = getattr(self, "tag_detector_ptr", None)
                self.tag_detector_ptr = None
                if pointer is not None:
                    self.libc.apriltag_detector_destroy.restype = None
                    self.libc.apriltag_detector_destroy(pointer)

        self._cv2 = cv2
        if family not in FAMILIES:
            raise UnknownNameError("tag family", family, FAMILIES)
        self._detector: Any = Detector(families=family, nthreads=1, quad_decimate=decimate)

    def find(self, frame: RgbdFrame) -> list[TagSeen]:
        """Return the tags in the colour picture; a number that is there twice is left out."""
        grey = self._cv2.cvtColor(frame.colour, self._cv2.COLOR_RGB2GRAY)
        found = [
            tag for tag in self._detector.detect(np.ascontiguousarray(grey))
            if tag.hamming == 0 and tag.decision_margin >= MIN_MARGIN
        ]  # fmt: skip
        count = Counter(tag.tag_id for tag in found)
        # the library counts from the outer edge of the first pixel; centres are whole here
        return [
            TagSeen(int(tag.tag_id), np.asarray(tag.corners, dtype=np.float64) - 0.5)
            for tag in found
            if count[tag.tag_id] == 1
        ]


def tag_poses(
    seen: Sequence[TagSeen], places: Mapping[int, TagPlace], camera: Intrinsics
) -> list[TagPose]:
    """Return the poses that explain the tags of one thing, the best first.

    A square seen from afar looks the same tilted to either side: each tag has two poses (Collins &
    Bartoli 2014, IPPE). Each is refined on the corners of all tags together.

    Parameters
    ----------
    seen : sequence of TagSeen
        Those of the thing.
    places : mapping of int to TagPlace
        Where they are stuck.
    camera : Intrinsics
        Of the picture.

    Returns
    -------
    list of TagPose
        That differ by more than 8°, and in which every tag faces the camera. Empty: none fits.
    """
    import cv2

    if not seen:
        return []
    points = np.vstack([places[tag.id].corners for tag in seen])
    pixels = np.vstack([tag.corners for tag in seen])
    if not np.isfinite(pixels).all():
        return []
    poses: list[TagPose] = []
    for tag in seen:
        place = places[tag.id]
        flat = (place.size * CORNERS)[_IPPE_ORDER]
        corners = np.ascontiguousarray(tag.corners[_IPPE_ORDER])
        count, turns, moves, _ = cv2.solvePnPGeneric(
            flat, corners, camera.matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
        )
        for k in range(count):
            start = _matrix(turns[k], moves[k]) @ np.linalg.inv(place.thing_from_tag)
            refined = _refined(points, pixels, camera.matrix, start)
            if refined is not None and _face(seen, places, refined.pose):
                poses.append(refined)
    poses.sort(key=lambda pose: pose.misfit)
    apart: list[TagPose] = []
    for pose in poses:
        if all(angle_between(pose.pose, other.pose) > ALIKE for other in apart):
            apart.append(pose)
    return [pose for pose in apart if pose.misfit <= WORST**2 * len(pixels)]


def angle_between(one: Array, other: Array) -> float:
    """Return the angle of the rotation between two poses, (4, 4) [rad]."""
    cosine = 0.5 * (np.trace(one[:3, :3].T @ other[:3, :3]) - 1.0)
    return math.acos(min(1.0, max(-1.0, float(cosine))))


def choose(
    poses: Sequence[TagPose], before: Array | None = None, up: tuple[Array, Array] | None = None
) -> tuple[TagPose, float] | None:
    """Choose among the poses that explain the same tags, or refuse to.

    Parameters
    ----------
    poses : sequence of TagPose
        From :func:`tag_poses`.
    before : (4, 4), optional
        Camera from thing a moment ago.
    up : pair of (3,), optional
        A direction in the thing's frame, and what it is in the camera's: the thing stands upright.

    Returns
    -------
    TagPose and its probability, or None
        None: two poses fit alike, and nothing tells which it is.
    """
    if not poses:
        return None
    # in a picture without any noise two poses may both fit to a hair; corners are never so good
    odds = [-0.5 * pose.worse_than(poses[0]) for pose in poses]
    for k, pose in enumerate(poses):
        if before is not None:
            odds[k] -= 0.5 * (angle_between(pose.pose, before) / MOVED) ** 2
        if up is not None:
            cosine = float(np.clip(pose.pose[:3, :3] @ up[0] @ up[1], -1.0, 1.0))
            odds[k] -= 0.5 * (math.acos(cosine) / LEANING) ** 2
    order = sorted(range(len(poses)), key=lambda k: -odds[k])
    best = order[0]
    # what was there before, or stands upright, cannot vouch for a pose that the picture contradicts
    if poses[best].worse_than(poses[0]) > 2.0 * DECIDED:
        return None
    if len(order) > 1 and 2.0 * (odds[best] - odds[order[1]]) < DECIDED:
        return None
    rest = sum(math.exp(max(odds[k] - odds[best], -700.0)) for k in order[1:])
    return poses[best], 1.0 / (1.0 + rest)


MOVED = math.radians(12.0)  # an object turns so far between two frames; guess
LEANING = math.radians(10.0)  # what stands upright, and the camera's pose, err so far; guess


def _refined(points: Array, pixels: Array, matrix: Array, start: Array) -> TagPose | None:
    import cv2

    turn, move = cv2.Rodrigues(start[:3, :3])[0], start[:3, 3:].copy()
    turn, move = cv2.solvePnPRefineLM(points, pixels, matrix, None, turn, move)
    projected, slopes = cv2.projectPoints(points, turn, move, matrix, None)
    pose = _matrix(turn, move)
    ahead = points @ pose[2, :3] + pose[2, 3]
    if not np.isfinite(pose).all() or (ahead <= 0.0).any():
        return None
    misfit = float(np.square(projected[:, 0] - pixels).sum())
    noise = max(CORNER_NOISE, math.sqrt(misfit / max(2 * len(points) - 6, 1)))
    slopes = slopes[:, :6]
    covariance = noise**2 * np.linalg.pinv(slopes.T @ slopes)
    return TagPose(pose, misfit, noise, covariance[3:, 3:])


def _matrix(turn: Array, move: Array) -> Array:
    import cv2

    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(turn)[0]
    pose[:3, 3] = np.asarray(move).ravel()
    return pose


def _face(seen: Sequence[TagSeen], places: Mapping[int, TagPlace], pose: Array) -> bool:
    """Whether every tag that was seen is seen from its front."""
    tags = [pose @ places[tag.id].thing_from_tag for tag in seen]
    return all(float(tag[:3, 2] @ tag[:3, 3]) < 0.0 for tag in tags)
