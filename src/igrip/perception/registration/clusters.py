"""What stands on the table: groups of points above it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, grey_dilation, label
from scipy.spatial import ConvexHull, QhullError

Array = NDArray[np.float64]

CELL = 0.008  # of the grid on the table [m]; a gap of two cells parts two groups
TABLE_CELL = 0.02  # of the grid that says where the table is [m]
LOWEST, HIGHEST = 0.012, 0.5  # what is looked at above the table [m]; guess
LEAST = 30  # points of a group, at least
DEEPEST, SUNK = 0.3, 0.025  # what is between them under the plane is no table, nor on one [m]
PASSING = 0.2  # with so many points under it, in shares of its own, a group passes the table by
BEYOND = 0.02  # what stands so far beyond the table's edge still stands on it [m]


class Cluster(NamedTuple):
    """Points that belong together.

    Attributes
    ----------
    points : (n, 3)
        In the frame of the table [m].
    depths : (n,)
        Along the optical axis [m].
    top : float
        Height of all but the highest points [m].
    """

    points: Array
    depths: Array
    top: float


def clusters_above(points: Array, depths: Array, spread: float) -> list[Cluster]:
    """Group what stands on the table, the largest group first.

    Points are grouped by where they are on the table, as seen from above: what an object hides of
    another from the camera does not cut it in two that way.

    Parameters
    ----------
    points : (n, 3)
        In the frame of the table, z up [m].
    depths : (n,)
        Along the optical axis [m].
    spread : float
        Noise, see :class:`igrip.perception.registration.plane.Plane`.
    """
    noise = spread * depths**2
    table = np.abs(points[:, 2]) < np.maximum(0.006, 2.5 * noise)
    lowest = np.maximum(LOWEST, 3.0 * noise)
    above = (points[:, 2] > lowest) & (points[:, 2] < HIGHEST)
    above[above] &= _on_table(points[above, :2], points[table, :2])
    under = points[(points[:, 2] < -SUNK - 3.0 * noise) & (points[:, 2] > -DEEPEST), :2]
    points, depths = points[above], depths[above]
    if len(points) < LEAST:
        return []
    groups, sunk = _grouped(points[:, :2], under)
    result = []
    for number in range(1, groups.max() + 1):
        own = groups == number
        if own.sum() >= LEAST and sunk[number] < PASSING * own.sum():
            top = float(np.percentile(points[own, 2], 97.0))
            result.append(Cluster(points[own], depths[own], top))
    return sorted(result, key=lambda cluster: -len(cluster.points))


def _grouped(points: Array, under: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the number of the group of each point of the table (n, 2), from 1; 0: alone.

    And how many points under the table (m, 2) are beneath each group, by number.
    """
    low = points.min(axis=0)
    cells = np.floor((points - low) / CELL).astype(np.int64) + 1
    counts = np.zeros(cells.max(axis=0) + 2, dtype=np.int64)
    np.add.at(counts, (cells[:, 0], cells[:, 1]), 1)
    numbers, found = label(counts >= 2, structure=np.ones((3, 3)))
    result: NDArray[np.int64] = numbers[cells[:, 0], cells[:, 1]]
    beneath = np.floor((under - low) / CELL).astype(np.int64) + 1
    inside = ((beneath >= 0) & (beneath < counts.shape)).all(axis=1)
    beside = grey_dilation(numbers, size=(3, 3))
    sunk = np.bincount(beside[tuple(beneath[inside].T)], minlength=found + 1)
    return result, sunk


def _on_table(points: Array, table: Array) -> NDArray[np.bool_]:
    """Whether points are over the table, the convex hull of its largest piece."""
    if len(table) < LEAST:
        return np.zeros(len(points), dtype=np.bool_)
    low = table.min(axis=0)
    cells = np.floor((table - low) / TABLE_CELL).astype(np.int64)
    counts = np.zeros(cells.max(axis=0) + 1, dtype=np.int64)
    np.add.at(counts, (cells[:, 0], cells[:, 1]), 1)
    held = binary_closing(np.pad(counts >= 3, 3), iterations=2)[3:-3, 3:-3]
    pieces, found = label(held)
    if not found:
        return np.zeros(len(points), dtype=np.bool_)
    largest = 1 + int(np.argmax(np.bincount(pieces.ravel())[1:]))
    corners = (np.argwhere(pieces == largest) + 0.5) * TABLE_CELL + low
    try:
        edges = ConvexHull(corners).equations  # outward unit normals, and offsets
    except QhullError:
        return np.zeros(len(points), dtype=np.bool_)
    inside = np.all(points @ edges[:, :2].T + edges[:, 2] <= BEYOND, axis=1)
    return np.asarray(inside)
