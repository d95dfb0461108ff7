"""Poses of meshes, and what kernels do with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from igrip.compiled import kernel
from igrip.rgbd import Array


class RigidPose(NamedTuple):
    """From the frame of a mesh to another: rotation (3, 3) and translation (3,) [m]."""

    rotation: Array
    translation: Array

    def apply(self, points: Array) -> Array:
        """Return points of the mesh, (n, 3) or (3,), in the other frame [m]."""
        return np.asarray(points @ self.rotation.T + self.translation)

    def to_mesh(self, points: Array) -> Array:
        """Return points of the other frame, (n, 3), in that of the mesh [m]."""
        return np.asarray((points - self.translation) @ self.rotation)

    def after(self, pose: Array) -> RigidPose:
        """Return this pose, carried on by another, (4, 4)."""
        return RigidPose(
            pose[:3, :3] @ self.rotation, pose[:3, :3] @ self.translation + pose[:3, 3]
        )


@kernel
def rotate(r: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a vector, turned by r (3, 3)."""
    return (
        r[0, 0] * x + r[0, 1] * y + r[0, 2] * z,
        r[1, 0] * x + r[1, 1] * y + r[1, 2] * z,
        r[2, 0] * x + r[2, 1] * y + r[2, 2] * z,
    )


@kernel
def rotate_back(r: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a vector, turned by the inverse of r (3, 3)."""
    return (
        r[0, 0] * x + r[1, 0] * y + r[2, 0] * z,
        r[0, 1] * x + r[1, 1] * y + r[2, 1] * z,
        r[0, 2] * x + r[1, 2] * y + r[2, 2] * z,
    )


@kernel
def turn_about(pose: RigidPose, centre: Array, w: Array, shift: Array) -> None:
    """Turn a pose by the rotation vector w (3,) about a point, then shift it; in place."""
    rotation, translation = pose
    angle = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    q = np.eye(3)
    if angle > 1e-12:
        x, y, z = w[0] / angle, w[1] / angle, w[2] / angle
        s, c = np.sin(angle), np.cos(angle)
        d = 1.0 - c
        q[0, 0], q[0, 1], q[0, 2] = c + x * x * d, x * y * d - z * s, x * z * d + y * s
        q[1, 0], q[1, 1], q[1, 2] = y * x * d + z * s, c + y * y * d, y * z * d - x * s
        q[2, 0], q[2, 1], q[2, 2] = z * x * d - y * s, z * y * d + x * s, c + z * z * d
    old = rotation.copy()
    away = translation - centre
    for i in range(3):
        translation[i] = centre[i] + shift[i]
        for j in range(3):
            translation[i] += q[i, j] * away[j]
            total = 0.0
            for k in range(3):
                total += q[i, k] * old[k, j]
            rotation[i, j] = total
