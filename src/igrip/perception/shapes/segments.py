"""What stands on the table, piece by piece, in the picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from igrip.perception.registration.clusters import label_above
from igrip.perception.registration.fit import PoseFit
from igrip.perception.registration.search import on_object
from igrip.perception.registration.view import DepthView, measured_points
from igrip.perception.shapes.primitives import Footprint
from igrip.rgbd import Array

STRIDE = 2  # pixels
BORDER = 4  # what is so near to the picture's edge goes on beyond it [pixels]
MIN_POINTS = 40  # of a thing
NEAR_HAND = 0.03  # what touches a hand is not judged: it may be the arm [m]
ARM_LENGTH, ARM_WIDTH = 0.2, 0.6  # a longer piece that enters the picture is an arm [m]; guess
YAWS = np.radians(np.arange(0.0, 90.0, 3.0))


class Segment(NamedTuple):
    """The visible part of one thing."""

    points: Array  # (n, 3), in the frame of the table [m]
    pixels: NDArray[np.int64]  # (n, 2), u and v
    footprint: Footprint
    cut: bool  # it goes on beyond the picture's edge
    touched: bool  # a hand is on it, or it is an arm

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
    segments = []
    for label in range(1, int(labels.max(initial=0)) + 1):
        own = labels == label
        rest = own & free & ~hand
        # what is left of a known thing's cluster is its rim, unless it is a good part
        if rest.sum() < max(MIN_POINTS, 0.15 * own.sum()):
            continue
        touched = bool((own & hand).any()) or _near(table[rest], table[hand & ~own])
        segments.append(_segment(table[rest], pixels[rest], depth.shape, touched))
    return segments


def _segment(
    points: Array, pixels: NDArray[np.int64], shape: tuple[int, ...], touched: bool
) -> Segment:
    footprint = footprint_of(points)
    size = np.array([shape[1], shape[0]])
    cut = bool(((pixels < BORDER).any(axis=1) | (pixels >= size - BORDER).any(axis=1)).any())
    longer, shorter = 2.0 * footprint.half
    arm = cut and longer > ARM_LENGTH and shorter < ARM_WIDTH * longer
    return Segment(points, pixels, footprint, cut, touched or arm)


def _near(points: Array, hand: Array) -> bool:
    """Whether a hand's points (m, 3) come near to others (n, 3)."""
    if not len(hand):
        return False
    low, high = points.min(axis=0) - NEAR_HAND, points.max(axis=0) + NEAR_HAND
    return bool(((hand > low) & (hand < high)).all(axis=1).any())


def footprint_of(points: Array) -> Footprint:
    """Return the footprint of points (n, 3) over the table [m]."""
    flat = points[:, :2]
    try:
        flat = flat[ConvexHull(flat).vertices]
    except QhullError:
        pass  # on one line: all of them
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
