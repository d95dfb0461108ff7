"""One view of the thing: its points with normals, and the depth picture they are from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter
from scipy.spatial import cKDTree

from igrip.perception.registration.view import DepthView, measured_points
from igrip.perception.scan.find import Sighting
from igrip.perception.scan.planar_pose import PlanarPose
from igrip.rgbd import Array

SPACING = 0.0025  # between the points that views are registered with [m]
NEIGHBOURS = 14  # of a point, its normal is that of the plane through them
MIN_COSINE = 0.25  # between normal and line of sight; at less a point counts for nothing
LOWEST = 0.006  # over the table, of points that count, besides noise [m]
BESIDE = 0.012  # a point so near to those of the sighting is of the thing, too [m]


@dataclass(frozen=True, eq=False)
class ScanView:
    """What one view shows; poses are object-from-table."""

    points: Array  # (n, 3), frame of the table [m]
    normals: Array  # (n, 3), outward
    sighting: Sighting
    colour: NDArray[np.uint8]  # (h, w, 3)
    nearest: Array  # (h, w), least depth about each pixel [m]; 0: not measured
    pose: PlanarPose
    registered: float = 0.0  # yaw, before all views were moved together [rad]

    def placed(self, pose: PlanarPose) -> ScanView:
        """Return the view in another pose."""
        return replace(self, pose=pose)

    def registered_at(self, pose: PlanarPose) -> ScanView:
        """Return the view in the pose in which it was registered."""
        return replace(self, pose=pose, registered=pose.yaw)

    @property
    def in_object(self) -> tuple[Array, Array]:
        """Points and normals, (n, 3) each, in the frame of the object."""
        return self.pose.apply(self.points), self.pose.turn(self.normals)


def scan_view(
    sighting: Sighting, colour: NDArray[np.uint8], reach: tuple[float, float], pose: PlanarPose
) -> ScanView:
    """Return the view of a sighting; for the parameters see :class:`ScanView`."""
    view = sighting.view
    points = _points_of(sighting, reach)
    normals = _normals(points, view)
    camera = view.table_from_camera[:3, 3]
    ahead = camera - points
    cosine = (normals * ahead).sum(axis=1) / np.linalg.norm(ahead, axis=1)
    good = cosine > MIN_COSINE
    least = minimum_filter(np.where(view.depth > 0.0, view.depth, np.inf), 3)
    nearest = np.where(view.depth > 0.0, least, 0.0)
    return ScanView(points[good], normals[good], sighting, colour, nearest, pose)


def _points_of(sighting: Sighting, reach: tuple[float, float]) -> Array:
    """Return evenly spaced points of the thing, down to the table, (n, 3) in its frame [m]."""
    view = sighting.view
    points, _ = measured_points(view.depth, view.intrinsics, 1, reach)
    table = points @ view.table_from_camera[:3, :3].T + view.table_from_camera[:3, 3]
    low, high = sighting.points.min(axis=0) - BESIDE, sighting.points.max(axis=0) + BESIDE
    lowest = max(LOWEST, 2.0 * view.noise * float(np.median(points[:, 2])) ** 2)
    inside = ((table > low) & (table < high))[:, :2].all(axis=1) & (table[:, 2] > lowest)
    table = table[inside & (table[:, 2] < high[2])]
    away, _ = nearest(cKDTree(sighting.points), table, BESIDE)
    return thinned(table[np.isfinite(away)], SPACING)


def nearest(tree: cKDTree, points: Array, bound: float) -> tuple[Array, NDArray[np.int64]]:
    """Return how far the nearest points of a tree are, (n,) [m], and which they are, (n,).

    Infinity: none is within ``bound`` [m].
    """
    away, number = tree.query(points, distance_upper_bound=bound)
    return np.asarray(away, dtype=np.float64), np.asarray(number, dtype=np.int64)


def thinned(points: Array, spacing: float) -> Array:
    """Return one mean point for each cube of a grid, (m, 3) of (n, 3) [m]."""
    if not len(points):
        return points
    cells = np.floor(points / spacing).astype(np.int64)
    _, number, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    sums = np.zeros((len(counts), 3))
    np.add.at(sums, number.reshape(-1), points)
    return np.asarray(sums / counts[:, None])


def _normals(points: Array, view: DepthView) -> Array:
    """Return unit normals of points (n, 3), towards the camera."""
    _, near = cKDTree(points).query(points, k=min(NEIGHBOURS, len(points)))
    around = points[near]
    centred = around - around.mean(axis=1, keepdims=True)
    normals = np.linalg.eigh(np.einsum("nki,nkj->nij", centred, centred))[1][:, :, 0]
    ahead = view.table_from_camera[:3, 3] - points
    return np.asarray(normals * np.sign((normals * ahead).sum(axis=1))[:, None])
