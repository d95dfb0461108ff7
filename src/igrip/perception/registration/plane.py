"""The plane that objects stand on, from the points of one frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from igrip.perception.transforms import rigid
from igrip.rgbd import Array

SAMPLED = 4000
HYPOTHESES = 300
MIN_SHARE = 0.12  # of the points; a smaller plane is no table; guess
NEAR = (0.006, 0.006)  # within which distance of a plane a point is on it: a + b z² [m, 1/m]


class Plane(NamedTuple):
    """A plane, and the frame of a table on it: its origin is the camera's foot on the plane."""

    table_from_camera: Array  # (4, 4); z up, towards the camera's side
    noise: float  # of the depth: its standard deviation normal to the plane is noise z² [1/m]
    share: float  # of the points, which is on it


def find_plane(points: Array, random: np.random.Generator) -> Plane | None:
    """Find the plane that most points are on (RANSAC; Fischler & Bolles 1981, then least squares).

    ``points`` (n, 3) are in the camera's frame [m]; ``random`` chooses the hypotheses. None: no
    plane holds enough of the points.
    """
    if len(points) < 100:
        return None
    chosen = points[random.choice(len(points), size=min(SAMPLED, len(points)), replace=False)]
    near = NEAR[0] + NEAR[1] * chosen[:, 2] ** 2
    corners = chosen[random.integers(len(chosen), size=(HYPOTHESES, 3))]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    fit = length > 1e-4  # m²: three points nearly on a line determine no plane
    if not fit.any():
        return None
    normals = normals[fit] / length[fit, None]
    offsets = (normals * corners[fit, 0]).sum(axis=1)
    counts = (np.abs(chosen @ normals.T - offsets) < near[:, None]).sum(axis=0)
    best = int(np.argmax(counts))
    return refine_plane(chosen, normals[best], float(offsets[best]))


def refine_plane(points: Array, normal: Array, offset: float) -> Plane | None:
    """Fit a plane ``normal · p = offset`` to the points near it, by weighted least squares."""
    near = NEAR[0] + NEAR[1] * points[:, 2] ** 2
    share, gaps = 0.0, np.empty(0)
    for _ in range(4):
        gaps = points @ normal - offset
        on = np.abs(gaps) < near
        share = float(on.mean())
        if share < MIN_SHARE or on.sum() < 50:
            return None
        weights = 1.0 / points[on, 2] ** 4  # the variance of a stereo camera's depth
        middle = np.average(points[on], axis=0, weights=weights)
        centred = (points[on] - middle) * np.sqrt(weights)[:, None]
        normal = np.linalg.eigh(centred.T @ centred)[1][:, 0]
        offset = float(normal @ middle)
    if offset > 0.0:  # the camera is at the origin, and above the plane
        normal, offset = -normal, -offset
    gaps = points @ normal - offset
    on = np.abs(gaps) < near
    noise = 1.4826 * float(np.median(np.abs(gaps[on]) / points[on, 2] ** 2))
    return Plane(_frame(normal, offset), noise, share)


def _frame(normal: Array, offset: float) -> Array:
    """Return table-from-camera: z along the normal, y away from the camera."""
    ahead = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.95 else np.array([0.0, -1.0, 0.0])
    y = ahead - (ahead @ normal) * normal
    y /= np.linalg.norm(y)
    return rigid(np.stack([np.cross(y, normal), y, normal]), (0.0, 0.0, -offset))
