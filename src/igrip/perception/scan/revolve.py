"""Things that look the same from all sides: one view, turned about their axis."""

from __future__ import annotations

import numpy as np

from igrip.perception.scan.planar_pose import PlanarPose
from igrip.perception.scan.scan_view import ScanView
from igrip.rgbd import Array

SIDES = 36  # views all round
BAND = 0.003  # heights in which radii are compared [m]
MAX_SPREAD = 0.0025  # root mean square of radii at one height, besides noise [m]; guess
MIN_ARC = np.radians(100.0)  # of its side that one view shows, at least; guess
UPRIGHT = 0.5  # cosine between normal and table, of points on a side


def views_all_round(view: ScanView) -> list[ScanView] | None:
    """Return a view, turned all round about the axis of what it shows; None: it is not round."""
    side = np.linalg.norm(view.normals[:, :2], axis=1) > UPRIGHT
    points, normals = view.points[side], view.normals[side]
    if len(points) < 50:
        return None
    axis = _crossing(points, normals)
    for _ in range(10):
        residual, slope = _spread(points, axis)
        axis = axis - np.linalg.lstsq(slope, residual, rcond=None)[0]
    residual, _ = _spread(points, axis)
    if _arc(points, axis) < MIN_ARC:  # a flat side is round about an axis far away
        return None
    noise = view.sighting.view.noise * float(np.median(view.sighting.view.depth)) ** 2
    if float(np.sqrt((residual**2).mean())) > MAX_SPREAD + noise:
        return None
    pose = PlanarPose(0.0, -float(axis[0]), -float(axis[1]))
    turns = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    return [view.placed(pose.moved(float(turn), 0.0, 0.0)) for turn in turns]


def _crossing(points: Array, normals: Array) -> Array:
    """Return where the horizontal normals of points (n, 3) cross, (2,) [m]."""
    flat = normals[:, :2] / np.linalg.norm(normals[:, :2], axis=1, keepdims=True)
    across = np.stack([-flat[:, 1], flat[:, 0]], axis=1)
    wanted = (across * points[:, :2]).sum(axis=1)
    weight = np.ones(len(points))
    axis = np.zeros(2)
    for _ in range(8):
        axis = np.linalg.lstsq(across * weight[:, None], wanted * weight, rcond=None)[0]
        off = wanted - across @ axis
        weight = 1.0 / np.sqrt(1.0 + (off / 0.005) ** 2)
    return np.asarray(axis)


def _arc(points: Array, axis: Array) -> float:
    """Return which angle points (n, 3) span about a vertical axis at (2,) [rad]."""
    away = points[:, :2] - axis
    angles = np.sort(np.arctan2(away[:, 1], away[:, 0]))
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * np.pi))
    return float(2.0 * np.pi - gaps.max())


def _spread(points: Array, axis: Array) -> tuple[Array, Array]:
    """Return how far each radius is from those at its height, (n,) [m], and its slope (n, 2)."""
    away = points[:, :2] - axis
    radius = np.linalg.norm(away, axis=1)
    slope = -away / np.maximum(radius, 1e-6)[:, None]
    band = np.floor(points[:, 2] / BAND).astype(np.int64)
    band -= band.min()
    counts = np.maximum(np.bincount(band), 1)
    residual = radius - (np.bincount(band, radius) / counts)[band]
    mean = np.stack([(np.bincount(band, slope[:, k]) / counts)[band] for k in (0, 1)], axis=1)
    return residual, slope - mean
