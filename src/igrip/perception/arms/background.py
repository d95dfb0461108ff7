"""The learned background: pixel by pixel, the depth that was measured there for a while."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

Mask = NDArray[np.bool_]
Depths = NDArray[np.float32]

WEIGHT = 0.2  # of the newest depth in the mean; guess
DISCLOSED_FOR = 0.5  # s for which a place that something left is remembered; guess


class Changes(NamedTuple):
    """What differs from the background, (h, w) each."""

    nearer: Mask  # something is in front of it, or it is not known yet
    known: Mask  # the background is known there
    lost: Mask  # nothing is measured where it was: dark cloth, for one, gives no depth
    disclosed: Mask  # a moment ago something farther came into view


class Background:
    """The background of one camera.

    Parameters
    ----------
    shape : (int, int)
        Of the pictures.
    settle : float
        For so long a nearer depth must stay to become background [s].
    """

    def __init__(self, shape: tuple[int, int], settle: float) -> None:
        self._settle = settle
        self._level: Depths = np.zeros(shape, np.float32)  # 0: not known
        self._candidate: Depths = np.zeros(shape, np.float32)
        self._stays: Depths = np.zeros(shape, np.float32)  # s, of the candidate
        self._left: Depths = np.full(shape, np.inf, np.float32)  # s since something left
        self._missing = np.zeros(shape, np.uint8)  # frames without depth

    def compare(self, depth: Depths, tolerance: Depths, dt: float) -> Changes:
        """Return what differs in a depth picture, (h, w) [m]; ``tolerance`` is of its noise [m]."""
        measured, known = depth > 0.0, self._level > 0.0
        away = depth - self._level
        farther = solid(measured & known & (away > tolerance))
        self._left = np.where(farther, np.float32(0.0), self._left + np.float32(dt))
        self._missing = np.where(measured, 0, np.minimum(self._missing, 250) + 1).astype(np.uint8)
        nearer = measured & (~known | (away < -tolerance))
        lost = solid(known & (self._missing >= 2))
        return Changes(nearer, known, lost, self._left < DISCLOSED_FOR)

    def learn(self, depth: Depths, tolerance: Depths, dt: float, held: Mask, above: Mask) -> None:
        """Learn from a depth picture; where ``held``, nothing nearer becomes background.

        What is not ``above`` the table, nor in front of anything known, is background at once.
        """
        measured = depth > 0.0
        same = measured & (np.abs(depth - self._candidate) < tolerance)
        self._stays = np.where(same, self._stays + np.float32(dt), self._stays)
        self._candidate = np.where(
            same, self._candidate + np.float32(WEIGHT) * (depth - self._candidate), self._candidate
        )
        fresh = measured & ~same
        self._candidate = np.where(fresh, depth, self._candidate)
        self._stays = np.where(fresh, np.float32(0.0), self._stays)
        near = (self._level == 0.0) | (self._candidate < self._level - tolerance)
        self._stays = np.where(near & held, np.float32(0.0), self._stays)
        # what is farther was behind all along: two frames are enough
        wait = near & (above | (self._level > 0.0))
        settled = (self._candidate > 0.0) & (self._stays >= np.where(wait, self._settle, 0.0))
        settled &= same
        self._level = np.where(settled, self._candidate, self._level)

    def forget(self, where: Mask) -> None:
        """Take what is there now for no background, but for something in front of one."""
        self._level[where] = np.inf
        self._stays[where] = 0.0


def solid(mask: Mask) -> Mask:
    """Return a mask without single pixels and lines of them: edges flicker."""
    count = uniform_filter(mask.astype(np.float32), 3, mode="constant")
    result: Mask = mask & (count > 4.5 / 9.0)
    return result
