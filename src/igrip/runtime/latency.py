"""How fast and how old: the numbers of a stage, for the screen and for the end."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np

KEPT = 20_000  # newest durations and ages that are kept; ten minutes at 30 Hz
RECENT = 2.0  # s over which a rate is told


class LatencyMeter:
    """Notes when something was done, how long it took, and how old its frame was by then."""

    def __init__(self) -> None:
        self._times: deque[float] = deque(maxlen=256)
        self._took: deque[float] = deque(maxlen=KEPT)
        self._ages: deque[float] = deque(maxlen=KEPT)
        self.count = 0

    def note(self, now: float, took: float, age: float) -> None:
        """Note one thing that was done at ``now``, in so many seconds, of a frame so old [s]."""
        self._times.append(now)
        self._took.append(took)
        self._ages.append(age)
        self.count += 1

    def rate(self, now: float) -> float:
        """Return how often it was done lately [1/s]."""
        return sum(now - t < RECENT for t in list(self._times)) / RECENT

    def summary(self) -> dict[str, Any]:
        """Return the count, and median and 99th percentile of duration and of age [ms]."""
        told: dict[str, Any] = {"count": self.count}
        for name, values in (("took", list(self._took)), ("age", list(self._ages))):
            if values:
                p50, p99 = np.percentile(values, [50, 99]) * 1e3
                told |= {f"{name}_p50_ms": round(float(p50), 2),
                         f"{name}_p99_ms": round(float(p99), 2)}  # fmt: skip
        return told

    def ages(self) -> list[float]:
        """Return the kept ages, oldest first [s]."""
        return list(self._ages)
