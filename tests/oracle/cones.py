"""Cones of rays round the predicted velocities."""

from __future__ import annotations

import numpy as np

SLOW_SPEED, SLOW_ANGLE = 0.03, np.radians(25.0)
FAST_SPEED, FAST_ANGLE = 0.8, np.radians(8.0)
RAYS = 36


def pattern(rays=RAYS):
    """Return points of the unit disc: its centre, then a sunflower that starts along u."""
    golden = np.pi * (3.0 - np.sqrt(5.0))
    points = [(0.0, 0.0)]
    for k in range(1, rays):
        radius, angle = np.sqrt(k / (rays - 1)), golden * (k - 1)
        points.append((radius * np.cos(angle), radius * np.sin(angle)))
    return np.array(points)


def half_angle(speed):
    """Return the half-angle of the cone: linear in the speed between the two ends."""
    return float(np.interp(speed, [SLOW_SPEED, FAST_SPEED], [SLOW_ANGLE, FAST_ANGLE]))


def directions(apex, velocity, middle, fallbacks, rays=RAYS):
    """Return the rays (r, 3) of one cone, all in one frame.

    ``middle`` is the centre of the object's bounding box, towards which the first ray off the axis
    leans; ``fallbacks`` are the object's axes z and x, for a cone that points straight at it.
    """
    axis = velocity / np.linalg.norm(velocity)
    for candidate in (middle - apex, *fallbacks):
        u = candidate - (candidate @ axis) * axis
        if np.linalg.norm(u) > 1e-9 * np.linalg.norm(candidate):
            break
    u = u / np.linalg.norm(u)
    v = np.cross(axis, u)
    disc = np.tan(half_angle(np.linalg.norm(velocity))) * pattern(rays)
    return axis + disc[:, :1] * u + disc[:, 1:] * v
