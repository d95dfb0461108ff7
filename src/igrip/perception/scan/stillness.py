"""Frames of the last moment: whether the thing stands still, and its depth, averaged if it does."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_opening

from igrip.perception.scan.find import Sighting

JUMP = 0.012  # between two depths of a pixel, where the edge of something has moved [m]; guess
MAX_MOVED = 0.004  # share of such pixels, those that flicker apart, of a thing at rest; guess
PAUSE = 4.0  # moments without a frame, after which another one begins
MIN_FRAMES = 4  # of an average


class LastMoment:
    """The sightings of the last moment, for as long as no hand was at the thing.

    ``settle`` is how long a moment is [s]; ``still`` is whether it stood still for so long,
    ``began`` whether the newest sighting is the first of its moment.
    """

    def __init__(self, settle: float) -> None:
        self._settle = settle
        self.still = True
        self.began = False
        self._kept: deque[tuple[float, Sighting]] = deque()
        self._whole = False  # whether a whole moment went by

    def clear(self) -> None:
        """Forget them: a hand is at it."""
        self._kept.clear()
        self._whole = False

    def add(self, t: float, sighting: Sighting) -> None:
        """Take a sighting of time ``t`` [s]."""
        if self._kept and t - self._kept[-1][0] > PAUSE * self._settle:
            self.clear()
        self.began = not self._kept
        self._kept.append((t, sighting))
        while len(self._kept) > MIN_FRAMES and t - self._kept[0][0] > self._settle:
            self._kept.popleft()
            self._whole = True

    def best(self) -> Sighting | None:
        """Return the newest sighting, averaged if it stands still; None: wait for it."""
        if len(self._kept) < MIN_FRAMES or not self._whole:
            return None
        newest = self._kept[-1][1]
        self.still = is_same(self._kept[0][1], newest)
        if not self.still:
            return newest  # it turns by itself
        depth = average([sighting.view.depth for _, sighting in self._kept], newest.view.noise)
        return replace(newest, view=newest.view._replace(depth=depth))


def is_same(one: Sighting, other: Sighting) -> bool:
    """Whether two sightings show the thing in the same pose."""
    rows, columns = other.box
    a, b = one.view.depth[rows, columns], other.view.depth[rows, columns]
    measured = (a > 0.0) & (b > 0.0)
    limit = JUMP + 3.0 * other.view.noise * b**2
    moved = binary_opening(measured & (np.abs(b - a) > limit), np.ones((3, 3), dtype=np.bool_))
    return bool(moved.mean() < MAX_MOVED)


def average(depths: list[NDArray[np.float32]], noise: float) -> NDArray[np.float32]:
    """Return the mean of depth pictures (h, w) [m]; 0 where they disagree, as at edges."""
    stack = np.stack(depths)
    counts = (stack > 0.0).sum(axis=0)
    mean = stack.sum(axis=0, dtype=np.float64) / np.maximum(counts, 1)
    spread = np.where(stack > 0.0, np.abs(stack - mean), 0.0).mean(axis=0)
    bad = (counts < 0.5 * len(depths)) | (spread > 0.004 + 2.0 * noise * mean**2)
    return np.where(bad, 0.0, mean).astype(np.float32)
