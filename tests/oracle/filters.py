"""One-Euro filters of points and rotations (Casiez, Roussel & Vogel 2012)."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation, Slerp


def alpha(cutoff: float, dt: float) -> float:
    """Weight of a new sample: 1 / (1 + tau / dt), tau = 1 / (2 pi cutoff)."""
    tau = 1.0 / (2.0 * np.pi * cutoff)
    return 1.0 / (1.0 + tau / dt)


def one_euro_points(times, points, *, min_cutoff, beta, derivative_cutoff):
    """Filter points (n, 3); return filtered points, derivative and velocity, each (n, 3).

    The derivative drives the cutoff: from the filtered point to the new sample, low-passed. It
    holds the filter's own lag. The velocity is that of the filtered point, low-passed alike.
    """
    points = np.asarray(points, dtype=float)
    filtered, derivative, velocity = points.copy(), np.zeros_like(points), np.zeros_like(points)
    for k in range(1, len(points)):
        dt = times[k] - times[k - 1]
        raw = (points[k] - filtered[k - 1]) / dt
        a = alpha(derivative_cutoff, dt)
        derivative[k] = a * raw + (1.0 - a) * derivative[k - 1]
        b = alpha(min_cutoff + beta * np.linalg.norm(derivative[k]), dt)
        filtered[k] = b * points[k] + (1.0 - b) * filtered[k - 1]
        moved = (filtered[k] - filtered[k - 1]) / dt
        velocity[k] = a * moved + (1.0 - a) * velocity[k - 1]
    return filtered, derivative, velocity


def one_euro_rotations(times, quaternions, *, min_cutoff, beta, derivative_cutoff):
    """Filter rotations (n, 4) x y z w; return scipy rotations, derivative and velocity (n, 3)."""
    rotations = Rotation.from_quat(quaternions)
    filtered, derivative = [rotations[0]], np.zeros((len(rotations), 3))
    velocity = np.zeros_like(derivative)
    for k in range(1, len(rotations)):
        dt = times[k] - times[k - 1]
        step = (rotations[k] * filtered[-1].inv()).as_rotvec()
        a = alpha(derivative_cutoff, dt)
        derivative[k] = a * step / dt + (1.0 - a) * derivative[k - 1]
        b = alpha(min_cutoff + beta * np.linalg.norm(derivative[k]), dt)
        way = Slerp([0.0, 1.0], Rotation.concatenate([filtered[-1], rotations[k]]))
        filtered.append(way(b))
        moved = (filtered[k] * filtered[k - 1].inv()).as_rotvec() / dt
        velocity[k] = a * moved + (1.0 - a) * velocity[k - 1]
    return Rotation.concatenate(filtered), derivative, velocity
