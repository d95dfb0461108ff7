"""How hands move from frame to frame: what they hold moves with them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from igrip.perception.registration.fit import PoseFit
from igrip.perception.registration.view import DepthView
from igrip.rgbd import Array

SAME_HAND = 0.20  # m; what is farther from every hand of the former frame is a new one; guess
AT_HAND = 0.04  # so near to the surface is a landmark of a hand that holds it [m]; guess
MIN_LANDMARKS = 2  # that must be so near
THICK = 0.10  # m; landmarks farther from the median depth are not on the hand


class MovingHand(NamedTuple):
    """A hand in one frame; lengths in the frame of the table [m].

    Attributes
    ----------
    points : (n, 3)
        Its landmarks; where no depth was measured, at the depth of the others.
    number : int
        The same from frame to frame.
    shift : (3,)
        By which it moved since the former frame; zero if it is new.
    speed : float
        The same by time [m/s].
    """

    points: Array
    number: int
    shift: Array
    speed: float

    @property
    def position(self) -> Array:
        """Where it is, (3,)."""
        position: Array = np.median(self.points, axis=0)
        return position


class _PictureHand(NamedTuple):
    """Where a hand was in the picture."""

    pixels: Array  # (n, 2)
    depths: Array  # (n,), 0 where none was measured [m]
    depth: float  # the median [m]
    number: int

    @property
    def middle(self) -> Array:
        middle: Array = np.median(self.pixels, axis=0)
        return middle


class HandMotion:
    """Follows hands by their landmarks, before one camera."""

    def __init__(self) -> None:
        self._hands: list[_PictureHand] = []
        self._count = 0
        self._t = 0.0

    def update(self, view: DepthView, hands: Sequence[Array], t: float) -> list[MovingHand]:
        """Add the landmarks of a frame, (n, 2) each [pixels]; return hands with depth."""
        before, self._hands = self._hands, []
        elapsed, self._t = max(t - self._t, 1e-3), t
        moving = []
        for landmarks in hands:
            pixels = np.asarray(landmarks, dtype=np.float64)
            depths = _depths_at(view, pixels)
            if not (depths > 0.0).any():
                continue
            depth = float(np.median(depths[depths > 0.0]))
            depths[np.abs(depths - depth) > THICK] = 0.0
            old = self._former(pixels, depth, before, view.intrinsics.fx)
            number = self._count if old is None else old.number
            self._count += old is None
            now = _PictureHand(pixels, depths, depth, number)
            self._hands.append(now)
            points = view.intrinsics.points(pixels, np.where(depths > 0.0, depths, depth))
            points = points @ view.table_from_camera[:3, :3].T + view.table_from_camera[:3, 3]
            shift = np.zeros(3) if old is None else _shift(old, now, view)
            speed = float(np.linalg.norm(shift)) / elapsed
            moving.append(MovingHand(points, number, shift, speed))
        return moving

    def _former(
        self, pixels: Array, depth: float, before: list[_PictureHand], fx: float
    ) -> _PictureHand | None:
        """Return the nearest hand of the former frame that is still free; None: none is near."""
        taken = {hand.number for hand in self._hands}
        near = [
            (float(np.linalg.norm(np.median(pixels, axis=0) - one.middle)) * depth / fx, k)
            for k, one in enumerate(before)
            if len(one.pixels) == len(pixels) and one.number not in taken
        ]
        away, k = min(near, default=(np.inf, 0))
        return before[k] if away < SAME_HAND else None


class Holders:
    """Which hand is at which thing, before one camera."""

    def __init__(self) -> None:
        self._hands: dict[str, int] = {}

    def hand_at(
        self, id: str, fit: PoseFit, visible: bool, hands: Sequence[MovingHand]
    ) -> MovingHand | None:
        """Return the hand that is at a thing, or was until it hid it; None: there is none."""
        before = self._hands.get(id)
        for hand in sorted(hands, key=lambda hand: hand.number != before):
            if (hand.number == before and not visible) or holds(hand, fit):
                self._hands[id] = hand.number
                return hand
        self._hands.pop(id, None)
        return None


def holds(hand: MovingHand, fit: PoseFit) -> bool:
    """Whether a hand is at a thing, so that it may hold it."""
    near = np.linalg.norm(hand.points - fit.centre, axis=1) < fit.shape.surface.radius + AT_HAND
    if near.sum() < MIN_LANDMARKS:
        return False
    distances = fit.shape.surface.field.distances(fit.pose.to_mesh(hand.points[near]))
    return int((distances < AT_HAND).sum()) >= MIN_LANDMARKS


def _depths_at(view: DepthView, pixels: Array) -> Array:
    height, width = view.depth.shape
    u, v = np.round(pixels).astype(int).T
    inside = (u >= 0) & (v >= 0) & (u < width) & (v < height)
    depths = np.zeros(len(pixels))
    depths[inside] = view.depth[v[inside], u[inside]]
    return depths


def _shift(old: _PictureHand, now: _PictureHand, view: DepthView) -> Array:
    """Return the movement of a hand, (3,): its pixels at one depth, and the depth's change."""
    both = (old.depths > 0.0) & (now.depths > 0.0)
    deeper = float(np.median(now.depths[both] - old.depths[both])) if both.sum() > 2 else 0.0
    pixels = np.median(np.stack([old.pixels, now.pixels]), axis=1)  # (2, 2)
    start, end = view.intrinsics.points(pixels, np.array([old.depth, old.depth + deeper]))
    shift: Array = view.table_from_camera[:3, :3] @ (end - start)
    return shift
