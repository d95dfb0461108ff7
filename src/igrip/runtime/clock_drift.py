"""How fast two clocks drift apart, by the least delays of their messages."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

MAX_DRIFT = 5e-4  # s per second by which clocks may drift apart: NTP's own limit of slewing
DRIFT_MARGIN = 5e-5  # s per second added to the estimated drift
BLOCK = 1.0  # s of which one minimum is kept for the drift
BLOCKS = (10, 60)  # that an estimate of the drift needs, and that are kept


class DriftEstimate:
    """The slope of the lower envelope of delays.

    Attributes
    ----------
    slope : float or None
        By how much delays grow [s/s]; None: not known yet.
    """

    def __init__(self) -> None:
        self.slope: float | None = None
        self._minima: deque[tuple[float, float]] = deque(maxlen=BLOCKS[1])
        self._end, self._block = -math.inf, (math.nan, math.inf)

    def add(self, arrived: float, delay: float) -> None:
        """Add the delay of a message [s]."""
        if arrived >= self._end:
            if math.isfinite(self._block[1]):
                self._minima.append(self._block)
                self.slope = _slope(self._minima)
            self._end, self._block = arrived + BLOCK, (math.nan, math.inf)
        if delay < self._block[1]:
            self._block = (arrived, delay)

    @property
    def max_rise(self) -> float:
        """How fast the lower envelope may rise [s/s]; faster is lateness."""
        if self.slope is None:
            return MAX_DRIFT
        return min(max(self.slope, 0.0) + DRIFT_MARGIN, MAX_DRIFT)


def _slope(minima: deque[tuple[float, float]]) -> float | None:
    """Return the median of the slopes between all pairs (Theil 1950, Sen 1968)."""
    if len(minima) < BLOCKS[0]:
        return None
    points = np.array(minima)
    first, second = np.triu_indices(len(points), 1)
    steps = points[second] - points[first]
    return float(np.median(steps[:, 1] / steps[:, 0]))
