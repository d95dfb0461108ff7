"""One frame as registration uses it: depth, what hides it, the table, and points over it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.perception.registration.plane import Plane
from igrip.perception.registration.visibility import local_depths
from igrip.perception.transforms import inverse
from igrip.rgbd import Array, Intrinsics, RgbdFrame

LANDMARKS = 21  # of a detector that knows fingers
FLESH = 0.035  # a hand reaches so far beyond its landmarks and the bones between them [m]; guess
SKIN = 0.011  # and so far it is the hand itself, not what it holds [m]; guess
NEAR, ON = 1, 2  # what a mask says of a pixel: near a hand; on it
PALM = (0, 1, 5, 9, 13, 17)  # landmarks round the palm
FINGERS = ((0, 1, 2, 3, 4), (0, 5, 6, 7, 8), (9, 10, 11, 12), (13, 14, 15, 16), (0, 17, 18, 19, 20))


class DepthView(NamedTuple):
    """The depth picture of a frame, and its table.

    An argument of functions with ``@kernel``: the cache of compiled code notices an edit here.
    """

    depth: NDArray[np.float32]  # (h, w), along the optical axis [m]; 0: not measured
    mask: NDArray[np.uint8]  # (h, w): ON a hand, NEAR it, or 0
    intrinsics: Intrinsics
    table_from_camera: Array  # (4, 4)
    camera_from_table: Array
    noise: float  # as of igrip.perception.registration.plane.Plane
    tolerance: float  # within this distance, and what noise adds, a measurement fits [m]

    def beside_hands(self) -> DepthView:
        """Return the view of what is followed: of a hand only what is on it hides."""
        return self._replace(mask=(self.mask == ON).astype(np.uint8))


def depth_view(
    frame: RgbdFrame, hands: Sequence[Array], plane: Plane, tolerance: float
) -> DepthView:
    """Return the view of a frame; ``hands`` are landmarks, (21, 2) or (n, 2) each [pixels]."""
    assert frame.depth is not None
    depth = np.ascontiguousarray(frame.depth, dtype=np.float32)
    width, height, *pinhole = frame.intrinsics
    return DepthView(
        depth, hand_mask(depth, hands, frame.intrinsics.fx),
        Intrinsics(int(width), int(height), *map(float, pinhole)),
        plane.table_from_camera, inverse(plane.table_from_camera), plane.noise, tolerance,
    )  # fmt: skip


def measured_points(
    depth: NDArray[np.float32], intrinsics: Intrinsics, stride: int, reach: tuple[float, float]
) -> tuple[Array, NDArray[np.int64]]:
    """Return the measured points (n, 3) in the camera's frame [m], and their pixels (n, 2).

    Only every ``stride``-th pixel, and only depths within ``reach`` [m]; each is averaged over the
    pixels about it.
    """
    depths = np.empty(tuple(-(-n // stride) for n in depth.shape))
    local_depths(depth, stride, *reach, depths)
    v, u = np.nonzero(depths)
    pixels = np.stack([u, v], axis=1) * stride
    return intrinsics.points(pixels.astype(np.float64), depths[v, u]), pixels


def hand_mask(depth: NDArray[np.float32], hands: Sequence[Array], fx: float) -> NDArray[np.uint8]:
    """Return where a hand may be, shape (h, w): ON it, NEAR it, or 0.

    It is on and near its landmarks and the bones between them, and on its palm. Points of a
    detector without landmarks, any other number, have no bones between them.

    Its width in the picture depends on how far the hand is: the median of the depths at its
    landmarks; without any, half a metre.
    """
    mask = np.zeros(depth.shape, dtype=np.uint8)
    height, width = depth.shape
    for landmarks in hands:
        joints = np.asarray(landmarks, dtype=np.float64)
        u = np.clip(joints[:, 0].round(), 0, width - 1).astype(int)
        v = np.clip(joints[:, 1].round(), 0, height - 1).astype(int)
        depths = depth[v, u]
        measured = depths[depths > 0.0]
        away = float(np.median(measured)) if len(measured) else 0.5
        spots = _spots(joints)
        _mark(mask, spots, FLESH * fx / away, NEAR)
        _mark(mask, spots, SKIN * fx / away, ON)
    return mask


def _spots(joints: Array) -> Array:
    """Return points on the bones of a hand and on its palm, (n, 2) [pixels]."""
    spots = [joints]
    if len(joints) == LANDMARKS:
        for finger in FINGERS:
            bones = joints[list(finger)]
            spots += [bones[:-1] + share * np.diff(bones, axis=0) for share in (0.25, 0.5, 0.75)]
        palm = joints[list(PALM)]
        for share in (0.25, 0.5, 0.75):
            spots.append(palm + share * (palm.mean(axis=0) - palm))
    return np.concatenate(spots)


def _mark(mask: NDArray[np.uint8], spots: Array, radius: float, value: int) -> None:
    """Write a value into discs about spots (n, 2), where it is more than what is there."""
    height, width = mask.shape
    for x, y in spots:
        left, right = max(0, int(x - radius)), min(width, int(x + radius) + 1)
        top, bottom = max(0, int(y - radius)), min(height, int(y + radius) + 1)
        if left < right and top < bottom:
            rows, columns = np.ogrid[top:bottom, left:right]
            near = (columns - x) ** 2 + (rows - y) ** 2 <= radius**2
            part = mask[top:bottom, left:right]
            part[near] = np.maximum(part[near], value)
