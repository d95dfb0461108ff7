"""Poses of a thing that stands on a table: it moves on it and turns about the vertical."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from igrip.rgbd import Array


@dataclass(frozen=True)
class PlanarPose:
    """Object-from-table: a turn about z by ``yaw`` [rad], then a shift by ``x`` and ``y`` [m]."""

    yaw: float
    x: float
    y: float

    @property
    def rotation(self) -> Array:
        """The turn, (3, 3)."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    @property
    def shift(self) -> Array:
        """The shift, (3,) [m]."""
        return np.array([self.x, self.y, 0.0])

    def apply(self, points: Array) -> Array:
        """Return points of the table, (n, 3), in the frame of the object [m]."""
        return np.asarray(points @ self.rotation.T + self.shift)

    def turn(self, directions: Array) -> Array:
        """Return directions (n, 3) of the table in the frame of the object."""
        return np.asarray(directions @ self.rotation.T)

    def to_table(self, points: Array) -> Array:
        """Return points of the object, (n, 3), in the frame of the table [m]."""
        return np.asarray((points - self.shift) @ self.rotation)

    def moved(self, yaw: float, x: float, y: float) -> PlanarPose:
        """Return the pose, followed by a turn about the origin of the object and a shift [m]."""
        c, s = np.cos(yaw), np.sin(yaw)
        return PlanarPose(self.yaw + yaw, c * self.x - s * self.y + x, s * self.x + c * self.y + y)


def turned_about(pose: PlanarPose, yaw: float, centre: Array) -> PlanarPose:
    """Return a pose, followed by a turn about a point of the object, (2,) [m]."""
    x, y = (float(value) for value in centre[:2])
    return pose.moved(0.0, -x, -y).moved(yaw, x, y)


def wrapped(angle: float) -> float:
    """Return an angle between -pi and pi [rad]."""
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)
