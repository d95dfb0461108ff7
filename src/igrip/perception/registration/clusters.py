"""What stands on the table: clusters of points above it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, grey_dilation, label
from scipy.spatial import ConvexHull, QhullError

from igrip.rgbd import Array

CELL = 0.008  # of the grid on the table [m]; a gap of two cells parts two clusters
TABLE_CELL = 0.02  # of the grid that locates the table [m]
MIN_HEIGHT, MAX_HEIGHT = 0.012, 0.5  # of what is looked at above the table [m]; guess
MIN_POINTS = 30  # of a cluster
MAX_DEPTH, MIN_DEPTH = 0.3, 0.025  # under the table: a point between them stands on no table [m]
MAX_BELOW = 0.2  # of a cluster's points may be such points, else it stands beside the table
EDGE = 0.02  # what stands so far beyond the table's edge still stands on it [m]
ANGLES = np.radians([0.0, 45.0, 90.0, 135.0])  # in which a width is measured
ASIDE = np.stack([np.cos(ANGLES), np.sin(ANGLES)])


class Cluster(NamedTuple):
    """Points that belong together."""

    points: Array  # (n, 3), in the frame of the table [m]
    depths: Array  # (n,), along the optical axis [m]
    top: float  # height of all but the highest points [m]
    width: float = 0.0  # of the middle two thirds of the points, seen from above [m]

    def part(self, own: NDArray[np.bool_]) -> Cluster:
        """Return the cluster of some of its points, (n,) true."""
        return cluster_of(self.points[own], self.depths[own])


def cluster_of(points: Array, depths: Array) -> Cluster:
    """Return the cluster of points (n, 3), at depths (n,) [m]."""
    low, high = np.percentile(points[:, :2] @ ASIDE, (17.0, 83.0), axis=0)
    width = float((high - low).max())
    return Cluster(points, depths, float(np.percentile(points[:, 2], 97.0)), width)


def clusters_above(points: Array, depths: Array, noise: float) -> list[Cluster]:
    """Cluster what stands on the table, the largest cluster first.

    Points are clustered by where they are on the table, seen from above: so an object that stands
    before another does not cut it in two. For the parameters see :class:`Cluster` and
    :class:`igrip.perception.registration.plane.Plane`.
    """
    numbers = label_above(points, depths, noise)
    clusters = [
        cluster_of(points[own], depths[own])
        for number in range(1, int(numbers.max(initial=0)) + 1)
        if (own := numbers == number).any()
    ]
    return sorted(clusters, key=lambda cluster: -len(cluster.points))


def label_above(points: Array, depths: Array, noise: float) -> NDArray[np.int64]:
    """Return the number of the cluster of each point, (n,), from 1; 0: it belongs to none.

    As :func:`clusters_above`, for those who need to know which points they are.
    """
    labels = np.zeros(len(points), dtype=np.int64)
    std = noise * depths**2
    table = np.abs(points[:, 2]) < np.maximum(0.006, 2.5 * std)
    lowest = np.maximum(MIN_HEIGHT, 3.0 * std)
    above = (points[:, 2] > lowest) & (points[:, 2] < MAX_HEIGHT)
    above[above] &= _on_table(points[above, :2], points[table, :2])
    under = points[(points[:, 2] < -MIN_DEPTH - 3.0 * std) & (points[:, 2] > -MAX_DEPTH), :2]
    if above.sum() < MIN_POINTS:
        return labels
    numbers, below = _connected(points[above, :2], under)
    for number in range(1, numbers.max() + 1):
        own = numbers == number
        if own.sum() < MIN_POINTS or below[number] >= MAX_BELOW * own.sum():
            numbers[own] = 0
    labels[above] = numbers
    return labels


def _connected(points: Array, under: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the number of the cluster of each point of the table (n, 2), from 1; 0: alone.

    And how many points under the table (m, 2) are beneath each cluster, by number.
    """
    low = points.min(axis=0)
    cells = np.floor((points - low) / CELL).astype(np.int64) + 1
    counts = np.zeros(cells.max(axis=0) + 2, dtype=np.int64)
    np.add.at(counts, (cells[:, 0], cells[:, 1]), 1)
    labels, count = label(counts >= 2, structure=np.ones((3, 3)))
    numbers: NDArray[np.int64] = labels[cells[:, 0], cells[:, 1]]
    beneath = np.floor((under - low) / CELL).astype(np.int64) + 1
    inside = ((beneath >= 0) & (beneath < counts.shape)).all(axis=1)
    beside = grey_dilation(labels, size=(3, 3))
    below = np.bincount(beside[tuple(beneath[inside].T)], minlength=count + 1)
    return numbers, below


def _on_table(points: Array, table: Array) -> NDArray[np.bool_]:
    """Whether points are over the table, the convex hull of its largest piece."""
    if len(table) < MIN_POINTS:
        return np.zeros(len(points), dtype=np.bool_)
    low = table.min(axis=0)
    cells = np.floor((table - low) / TABLE_CELL).astype(np.int64)
    counts = np.zeros(cells.max(axis=0) + 1, dtype=np.int64)
    np.add.at(counts, (cells[:, 0], cells[:, 1]), 1)
    held = binary_closing(np.pad(counts >= 3, 3), iterations=2)[3:-3, 3:-3]
    pieces, count = label(held)
    if not count:
        return np.zeros(len(points), dtype=np.bool_)
    largest = 1 + int(np.argmax(np.bincount(pieces.ravel())[1:]))
    corners = (np.argwhere(pieces == largest) + 0.5) * TABLE_CELL + low
    try:
        edges = ConvexHull(corners).equations  # outward unit normals, and offsets
    except QhullError:
        return np.zeros(len(points), dtype=np.bool_)
    inside = np.all(points @ edges[:, :2].T + edges[:, 2] <= EDGE, axis=1)
    return np.asarray(inside)
