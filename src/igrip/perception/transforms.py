"""Rigid transforms, (4, 4), and the messages that carry them."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose
from igrip.rgbd import Array


def rigid(rotation: Array, translation: Any) -> Array:
    """Return the transform of a rotation, (3, 3), and a translation, (3,) [m]."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, translation
    return pose


def inverse(pose: Array) -> Array:
    """Return the inverse of a rigid transform."""
    return rigid(pose[:3, :3].T, -pose[:3, :3].T @ pose[:3, 3])


def is_rigid(pose: Array, tolerance: float) -> bool:
    """Whether a transform is a rotation, to this tolerance of its entries, and a translation."""
    rotation = pose[:3, :3]
    if not np.isfinite(pose).all() or pose[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        return False
    error = np.abs(rotation @ rotation.T - np.eye(3)).max()
    return bool(error <= tolerance and np.linalg.det(rotation) > 0.0)


def object_pose(world_from_mesh: Array, **fields: Any) -> ObjectPose:
    """Return the message of an object's pose; ``fields`` are its others."""
    x, y, z = world_from_mesh[:3, 3].tolist()
    a, b, c, d = Rotation.from_matrix(world_from_mesh[:3, :3]).as_quat().tolist()
    return ObjectPose(position=(x, y, z), orientation=(a, b, c, d), **fields)
