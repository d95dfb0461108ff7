"""What stands on the table, piece by piece, in the picture."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, label
from scipy.spatial import ConvexHull, QhullError, cKDTree

from igrip.perception.registration.clusters import label_above
from igrip.perception.registration.fit import PoseFit
from igrip.perception.registration.search import on_object
from igrip.perception.registration.view import DepthView, measured_points
from igrip.perception.shapes.primitives import Footprint
from igrip.rgbd import Array

STRIDE = 2  # pixels
BORDER = 4  # what is so near to the picture's edge goes on beyond it [pixels]
MIN_POINTS = 40  # of a thing
THIN = 2  # half the width of what does not hold a thing together [cells of the grid]
MIN_CORE = 15  # cells of a piece that are not at its edge
JUMP = 0.006  # between neighbouring points of one surface, besides noise [m]; guess
ON_TABLE = 0.045  # what is nowhere lower than that hovers [m]; guess
FOOT = 8  # so far below a piece it is looked what covers its foot [pixels]
NEAR_HAND = 0.03  # what touches a hand is not judged: it may be the arm [m]
ARM_LENGTH, ARM_WIDTH = 0.2, 0.6  # a longer piece that enters the picture is an arm [m]; guess
YAWS = np.radians(np.arange(0.0, 90.0, 3.0))


class Segment(NamedTuple):
    """The visible part of one thing."""

    points: Array  # (n, 3), in the frame of the table [m]
    pixels: NDArray[np.int64]  # (n, 2), u and v
    footprint: Footprint
    cut: bool  # it goes on beyond the picture's edge
    touched: bool  # a hand is on it, or it is an arm, or it hovers
    cluster: int  # pieces with the same one touch on the table

    @property
    def middle(self) -> Array:
        """Middle of its footprint, half way up, (3,), frame of the table [m]."""
        return np.append(self.footprint.middle, 0.5 * self.footprint.height)


def find_segments(
    depth: NDArray[np.float32], view: DepthView, reach: tuple[float, float],
    known: Sequence[PoseFit],
) -> list[Segment]:  # fmt: skip
    """Return what stands on the table and belongs to none of the known objects.

    Parameters
    ----------
    depth : (h, w)
        Depth, averaged where nothing moves [m].
    view : DepthView
        The newest frame: table, hands, noise.
    reach : 2 floats
        Depths that are looked at [m].
    known : sequence of PoseFit
        Objects whose points are left out.
    """
    points, pixels = measured_points(depth, view.intrinsics, STRIDE, reach)
    table = points @ view.table_from_camera[:3, :3].T + view.table_from_camera[:3, 3]
    labels = label_above(table, points[:, 2], view.noise)
    hand = view.mask[pixels[:, 1], pixels[:, 0]] > 0
    free = labels > 0
    for fit in known:
        free[free] &= ~on_object(fit, table[free])
    pieces = _pieces(pixels // STRIDE, points[:, 2], labels, view.noise)
    segments = []
    for piece in range(1, int(pieces.max(initial=0)) + 1):
        own = pieces == piece
        rest = own & free & ~hand
        # what is left of a known thing is its rim, unless it is a good part
        if rest.sum() < max(MIN_POINTS, 0.15 * own.sum()):
            continue
        touched = bool((own & hand).any()) or _near(table[rest], table[hand & ~own])
        touched |= _hovers(table[rest, 2], pixels[rest], depth)
        segments.append(
            _segment(table[rest], pixels[rest], depth.shape, touched, int(labels[own][0]))
        )
    return segments


def _pieces(
    cells: NDArray[np.int64], depths: Array, labels: NDArray[np.int64], noise: float
) -> NDArray[np.int64]:
    """Return the number of the piece of each point, (n,), from 1; 0: it is on no thing.

    Clusters on the table, (n,), are cut where the depth jumps in the picture, and where they are
    thin, as false depths between two things are: things that touch on the table seldom touch in
    space where they are seen. What is left, handles among it, goes to the nearest piece of its
    cluster. ``cells`` (n, 2) are pixels of the grid.
    """
    shape = cells.max(axis=0, initial=0) + 3
    cluster, depth = np.zeros(shape, dtype=np.int64), np.zeros(shape)
    at = tuple((cells + 1).T)
    cluster[at], depth[at] = labels, depths
    core = cluster > 0
    limit = JUMP + 1.5 * noise * depth**2
    for axis in (0, 1):
        for step in (-1, 1):
            other = np.roll(depth, step, axis)
            core &= (np.roll(cluster, step, axis) == cluster) & (np.abs(other - depth) < limit)
    core = binary_erosion(core, iterations=THIN - 1)
    found, _ = label(core * 1, structure=np.ones((3, 3)))
    # things that touch may have cores that touch, but never across a jump: cores are cut there
    number = found[at] * (labels > 0)
    sizes = np.bincount(number)
    sizes[0] = 0
    kept = np.cumsum(sizes >= MIN_CORE) * (sizes >= MIN_CORE)
    pieces: NDArray[np.int64] = kept[number]
    count = int(pieces.max(initial=0))
    for one in range(1, int(labels.max(initial=0)) + 1):
        own = np.flatnonzero(labels == one)
        whole, bits = own[pieces[own] > 0], own[pieces[own] == 0]
        if len(whole):
            pieces[bits] = pieces[whole[cKDTree(cells[whole]).query(cells[bits])[1]]]
        elif len(own) >= 3 * MIN_POINTS:  # less is an edge's false depths
            count += 1
            pieces[own] = count
    return pieces


def _segment(
    points: Array, pixels: NDArray[np.int64], shape: tuple[int, ...], touched: bool, cluster: int
) -> Segment:
    footprint = footprint_of(points)
    size = np.array([shape[1], shape[0]])
    cut = bool(((pixels < BORDER).any(axis=1) | (pixels >= size - BORDER).any(axis=1)).any())
    longer, shorter = 2.0 * footprint.half
    arm = cut and longer > ARM_LENGTH and shorter < ARM_WIDTH * longer
    return Segment(points, pixels, footprint, cut, touched or arm, cluster)


def _hovers(heights: Array, pixels: NDArray[np.int64], depth: NDArray[np.float32]) -> bool:
    """Whether a piece is over the table and not on it, as arms are, and what a hand holds.

    Heights (n,) over the table [m]. Where something nearer covers its foot, nothing is concluded.
    """
    if float(np.percentile(heights, 3.0)) < ON_TABLE:
        return False
    columns = np.unique(pixels[:, 0])
    lowest = np.array([pixels[pixels[:, 0] == column, 1].max() for column in columns])
    own = depth[lowest, columns]
    below = depth[np.minimum(lowest + FOOT, depth.shape[0] - 1), columns]
    covered = (below > 0.0) & (below < own - 0.02)
    return float(covered.mean()) < 0.4


def _near(points: Array, hand: Array) -> bool:
    """Whether a hand's points (m, 3) come near to others (n, 3)."""
    if not len(hand):
        return False
    low, high = points.min(axis=0) - NEAR_HAND, points.max(axis=0) + NEAR_HAND
    return bool(((hand > low) & (hand < high)).all(axis=1).any())


def footprint_of(points: Array) -> Footprint:
    """Return the footprint of points (n, 3) over the table [m]."""
    flat = points[:, :2]
    with suppress(QhullError):  # on one line: all of them
        flat = flat[ConvexHull(flat).vertices]
    c, s = np.cos(YAWS), np.sin(YAWS)
    u = flat[:, :1] * c + flat[:, 1:] * s  # (n, yaws)
    v = flat[:, 1:] * c - flat[:, :1] * s
    sizes = np.stack([np.ptp(u, axis=0), np.ptp(v, axis=0)])
    best = int(np.argmin(sizes.prod(axis=0)))
    mid_u, mid_v = (0.5 * (w[:, best].min() + w[:, best].max()) for w in (u, v))
    middle = np.array([c[best] * mid_u - s[best] * mid_v, s[best] * mid_u + c[best] * mid_v])
    half, yaw = 0.5 * sizes[:, best], float(YAWS[best])
    if half[1] > half[0]:
        half, yaw = half[::-1].copy(), yaw + 0.5 * np.pi
    return Footprint(middle, yaw, half, max(0.01, float(np.percentile(points[:, 2], 98.0))))
