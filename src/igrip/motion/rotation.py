"""Unit quaternions (x, y, z, w) as plain tuples.

The stream of object poses needs a handful of these operations on one rotation at a time, where the
calls of an array library cost many times the arithmetic. The tests hold them against scipy.
"""

from __future__ import annotations

import math

from igrip.entities import Quaternion, Vector

IDENTITY: Quaternion = (0.0, 0.0, 0.0, 1.0)


def normalise(q: Quaternion) -> Quaternion:
    """Return the quaternion scaled to length 1."""
    norm = math.hypot(*q)
    return (q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm)


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the rotation ``b`` followed by ``a``."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """Return the inverse rotation."""
    return (-q[0], -q[1], -q[2], q[3])


def exponential(v: Vector) -> Quaternion:
    """Return the rotation by ``|v|`` radians about ``v``."""
    angle = math.hypot(*v)
    scale = 0.5 - angle * angle / 48.0 if angle < 1e-4 else math.sin(0.5 * angle) / angle
    return (scale * v[0], scale * v[1], scale * v[2], math.cos(0.5 * angle))


def logarithm(q: Quaternion) -> Vector:
    """Return the shortest rotation vector of ``q`` [rad]."""
    x, y, z, w = q if q[3] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])
    sine = math.hypot(x, y, z)
    scale = 2.0 if sine < 1e-9 else 2.0 * math.atan2(sine, w) / sine
    return (scale * x, scale * y, scale * z)


def matrix(q: Quaternion) -> tuple[Vector, Vector, Vector]:
    """Return the rotation matrix, by rows."""
    x, y, z, w = q
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
