"""The tree of transforms of ROS: the pose of each frame in the frame at the root."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

MAX_FRAMES = 1024
MAX_DEPTH = 64  # of a tree; a longer chain is a circle


class Pose(NamedTuple):
    """A pose in another frame: position (3,) [m] and quaternion (4,) x, y, z, w."""

    position: NDArray[np.float64]
    quaternion: NDArray[np.float64]


class TransformTree:
    """The newest transform of each frame from its parent."""

    def __init__(self) -> None:
        self._parents: dict[str, tuple[str, Pose]] = {}

    def set(self, child: str, parent: str, pose: Pose) -> None:
        """Set the pose of a frame in its parent."""
        if child in self._parents or len(self._parents) < MAX_FRAMES:
            self._parents[child] = parent, pose

    def in_root(self, frame: str, pose: Pose) -> Pose:
        """Return a pose given in a frame in the frame at the root of the tree.

        A rotation that is none (zeros, NaN) stays so.
        """
        position, quaternion = pose
        for _ in range(MAX_DEPTH):
            if frame not in self._parents:
                break
            frame, (origin, turn) = self._parents[frame]
            if not _is_rotation(turn):
                return Pose(position * np.nan, quaternion * np.nan)
            rotation = Rotation.from_quat(turn)
            position = origin + rotation.apply(position)
            if _is_rotation(quaternion):
                quaternion = (rotation * Rotation.from_quat(quaternion)).as_quat()
        return Pose(position, quaternion)

    def is_parent(self, frame: str) -> bool:
        """Whether other frames are given in a frame."""
        return any(parent == frame for parent, _ in self._parents.values())


def _is_rotation(quaternion: NDArray[np.float64]) -> bool:
    return 0.5 < math.hypot(*quaternion) < 2.0
