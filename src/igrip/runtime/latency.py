"""Rate, durations and ages of repeated work."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np

MAX_SAMPLES = 20_000  # newest durations and ages that are kept; ten minutes at 30 Hz
RATE_WINDOW = 2.0  # s


class LatencyMeter:
    """Collects how often work was done, how long it took, and how old its input was at the end."""

    def __init__(self) -> None:
        self._times: deque[float] = deque(maxlen=256)
        self._durations: deque[float] = deque(maxlen=MAX_SAMPLES)
        self._ages: deque[float] = deque(maxlen=MAX_SAMPLES)
        self.count = 0

    def add(self, now: float, duration: float, age: float) -> None:
        """Add one piece of work that ended at ``now``; all in seconds."""
        self._times.append(now)
        self._durations.append(duration)
        self._ages.append(age)
        self.count += 1

    def rate(self, now: float) -> float:
        """Return how often work was done lately [1/s]."""
        return sum(now - t < RATE_WINDOW for t in list(self._times)) / RATE_WINDOW

    def summary(self) -> dict[str, Any]:
        """Return the count, and median and 99th percentile of duration and age [ms]."""
        summary: dict[str, Any] = {"count": self.count}
        for name, values in (("duration", list(self._durations)), ("age", list(self._ages))):
            if values:
                p50, p99 = np.percentile(values, [50, 99]) * 1e3
                summary |= {f"{name}_p50_ms": round(float(p50), 2),
                            f"{name}_p99_ms": round(float(p99), 2)}  # fmt: skip
        return summary

    def ages(self) -> list[float]:
        """Return the newest ages, oldest first [s]."""
        return list(self._ages)
