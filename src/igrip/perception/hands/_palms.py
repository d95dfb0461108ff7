"""From a detected hand to its palm in the world, where depth was measured on it.

The palm centre is the mean of landmarks 0, 5 and 17 (wrist, roots of the index and little finger),
as in the paper. A depth camera sees skin: the centre lies on the side of the hand that the camera
sees, 10 to 15 mm (half a hand's thickness) nearer to it than the middle of the hand.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Hand, Vector
from igrip.perception.hands import PALM, HandDetection
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import Settings, quantity

NEAR_QUANTILE = 0.25  # of the depths is on the hand: background is no more than 3/4; guess
SLOPE = 0.2  # prior of the relative change of depth over the length of a palm; 45° at 0.6 m: 0.15
ROUNDS = 3
MAX_PIXELS = 2500  # of the palm that are used


class PalmConfig(Settings):
    """When depth on a palm is enough, and how exact it is.

    Attributes
    ----------
    landmarks : bool
        Whether all 21 landmarks are measured, where each has depth.
    """

    min_pixels: int = quantity(25, "1", "pixels with depth on the palm", "guess", ge=4)
    min_share: float = quantity(
        0.3, "1", "of the palm's pixels with depth on the hand", "guess", gt=0, le=1
    )
    thickness: float = quantity(
        0.03, "m", "depths further from the palm's plane are not the palm's", "guess", gt=0
    )
    min_length: float = quantity(0.04, "m", "of a palm, wrist to knuckles or across", "guess", gt=0)
    max_length: float = quantity(0.16, "m", "of a palm", "guess", gt=0)
    correlation: float = quantity(
        6.0, "pixel", "within which errors of depth are alike", "guess", gt=0
    )
    jitter: float = quantity(
        0.03, "1", "standard deviation of the palm centre in the picture, in lengths of the palm",
        "docs/hands.md", ge=0,
    )  # fmt: skip
    min_std: float = quantity(
        0.001, "m", "of a depth: cameras count in steps of about so much", "guess", gt=0
    )
    landmarks: bool = False


DEFAULT = PalmConfig()


def measure_palm(
    hand: HandDetection, frame: RgbdFrame, config: PalmConfig = DEFAULT
) -> Hand | None:
    """Measure where a palm is, unless the detector did.

    A plane is fitted to the depths inside the triangle of the three landmarks, which background
    between fingers cannot enter; pixels off the nearer surface are left out.

    Returns
    -------
    Hand or None
        World frame, metres; ``std`` per world axis, from the spread of the depths along the ray and
        the detector's jitter across it. None: no depth, or too little of it.
    """
    if hand.measured is not None:
        return hand.measured
    if frame.depth is None:
        return None
    corners = hand.landmarks[list(PALM)]
    pixels, depths, whole = _inside(corners, frame.depth)
    if len(depths) < config.min_pixels:
        return None
    middle, unit = corners.mean(axis=0), max(_longest_side(corners), 1.0)
    plane, kept, spread = _fit((pixels - middle) / unit, depths, config.thickness)
    if kept < config.min_pixels or kept < config.min_share * whole:
        return None
    inverse = np.column_stack([(corners - middle) / unit, np.ones(3)]) @ plane
    if not (inverse > 0.0).all():
        return None
    points = frame.intrinsics.points(corners, 1.0 / inverse)
    if not config.min_length <= _longest_side(points) <= config.max_length:
        return None  # what the triangle covers is no palm
    centre = points.mean(axis=0)
    ray = centre / centre[2]
    along = max(spread / np.sqrt(max(kept / config.correlation**2, 1.0)), config.min_std)
    across = config.jitter * unit * centre[2] / frame.intrinsics.fx
    covariance = along**2 * np.outer(ray, ray) + across**2 * np.diag([1.0, 1.0, 0.0])
    rotation = frame.world_from_camera[:3, :3]
    std = np.sqrt(np.diag(rotation @ covariance @ rotation.T))
    landmarks = _landmarks(hand, frame, centre[2], unit, config) if config.landmarks else None
    return Hand(
        position=_world(frame, centre), t=frame.t, landmarks=landmarks,
        std=(float(std[0]), float(std[1]), float(std[2])), score=hand.score, source=frame.camera,
    )  # fmt: skip


def _world(frame: RgbdFrame, point: Array) -> Vector:
    x, y, z = frame.world_from_camera[:3, :3] @ point + frame.world_from_camera[:3, 3]
    return float(x), float(y), float(z)


def _longest_side(corners: Array) -> float:
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).max())


def _inside(corners: Array, depth: NDArray[np.float32]) -> tuple[Array, Array, int]:
    """Return the pixels (n, 2) of a triangle with depth, their depths, and how many it covers."""
    if not np.isfinite(corners).all():
        return np.empty((0, 2)), np.empty(0), 0
    height, width = depth.shape
    if not ((corners > -width) & (corners < 2 * width)).all():
        return np.empty((0, 2)), np.empty(0), 0
    low, high = np.floor(corners.min(axis=0)).astype(int), np.ceil(corners.max(axis=0)).astype(int)
    step = max(1, int(np.sqrt(np.prod(high - low + 1.0) / (2 * MAX_PIXELS))))
    us, vs = np.meshgrid(np.arange(low[0], high[0] + 1, step), np.arange(low[1], high[1] + 1, step))
    pixels = np.stack([us.ravel(), vs.ravel()], axis=1)
    turns = np.stack([_turn(corners[k], corners[(k + 1) % 3], pixels) for k in range(3)])
    pixels = pixels[(turns >= 0.0).all(axis=0) | (turns <= 0.0).all(axis=0)]
    u, v = pixels.T
    visible = pixels[(u >= 0) & (u < width) & (v >= 0) & (v < height)]
    depths = depth[visible[:, 1], visible[:, 0]].astype(np.float64)
    valid = np.isfinite(depths) & (depths > 0.0)
    return visible[valid].astype(np.float64), depths[valid], len(pixels)


def _turn(start: Array, end: Array, points: Array) -> Array:
    """Return on which side of a line points lie, by sign."""
    side: Array = (end[0] - start[0]) * (points[:, 1] - start[1]) - (end[1] - start[1]) * (
        points[:, 0] - start[0]
    )
    return side


def _fit(at: Array, depths: Array, thickness: float) -> tuple[Array, int, float]:
    """Fit a plane to the nearer surface; on a plane 1 / depth is linear in the pixels.

    Return the plane, (3,), so that 1 / depth [1/m] = plane · (u, v, 1), how many depths it rests
    on, and their standard deviation about it [m].
    """
    terms = np.column_stack([at, np.ones(len(at))])
    near = float(np.quantile(depths, NEAR_QUANTILE))
    plane = np.array([0.0, 0.0, 1.0 / near])
    gate = 2.0 * thickness  # the first plane faces the camera: a tilted palm is further off
    spread, kept = 0.0, 0
    for _ in range(ROUNDS):
        off = depths - 1.0 / np.maximum(terms @ plane, 1e-3)
        inliers = np.abs(off) < gate
        kept = int(inliers.sum())
        if kept < 3:
            return plane, 0, 0.0
        spread = float(1.4826 * np.median(np.abs(off[inliers])))
        prior = (max(spread, 1e-3) / SLOPE) ** 2 / near**2 * np.array([1.0, 1.0, 0.0])
        some = terms[inliers]
        plane = np.linalg.solve(some.T @ some + np.diag(prior), some.T @ (1.0 / depths[inliers]))
        gate = thickness
    return plane, kept, spread


def _landmarks(
    hand: HandDetection, frame: RgbdFrame, palm: float, unit: float, config: PalmConfig
) -> tuple[Vector, ...] | None:
    """Return all landmarks in the world, or None where one has no depth of the hand's."""
    assert frame.depth is not None
    height, width = frame.depth.shape
    radius = max(1, round(0.05 * unit))
    depths = np.empty(len(hand.landmarks))
    for k, (u, v) in enumerate(np.round(hand.landmarks).astype(int)):
        if not (0 <= u < width and 0 <= v < height):
            return None
        rows, columns = (slice(max(at - radius, 0), at + radius + 1) for at in (v, u))
        patch = frame.depth[rows, columns]
        near = patch[(patch > 0.0) & (np.abs(patch - palm) < config.max_length)]
        if len(near) == 0:
            return None
        near = near[near < np.quantile(near, NEAR_QUANTILE) + config.thickness]
        depths[k] = np.median(near)
    points = frame.intrinsics.points(hand.landmarks, depths)
    return tuple(_world(frame, point) for point in points)
