"""Time several contestants by turns, so that a slow moment of the machine slows them all."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Work = Callable[[int], object]


def interleaved(
    contestants: Mapping[str, Work], frames: Sequence[int], turn: int = 1, period: float = 0.0
) -> dict[str, NDArray[np.float64]]:
    """Time each contestant on each frame, by turns; return the seconds of each call, (n,).

    Parameters
    ----------
    contestants : mapping of str to function
        Each is called with the number of a frame.
    turn : int
        Frames that one contestant does in a row. With 1 each finds the processor's caches full of
        what the others left; with more, its own ("hot").
    period : float
        Seconds from the start of one round of turns to the next; the rest is slept. 0: no pause.
    """
    times: dict[str, list[float]] = {name: [] for name in contestants}
    clock = time.perf_counter
    gc.collect()
    gc.disable()  # a collection would be charged to whoever runs at that moment
    try:
        for first in range(0, len(frames), turn):
            begin = clock()
            for name, work in contestants.items():
                for frame in frames[first : first + turn]:
                    before = clock()
                    work(frame)
                    times[name].append(clock() - before)
            rest = begin + period - clock()
            if rest > 0.0:
                time.sleep(rest)
    finally:
        gc.enable()
    return {name: np.array(seconds) for name, seconds in times.items()}


def percentiles(seconds: NDArray[np.float64]) -> dict[str, float]:
    """Return the median and the 99th percentile [ms]."""
    return {
        "p50_ms": float(np.median(seconds)) * 1e3,
        "p99_ms": float(np.quantile(seconds, 0.99)) * 1e3,
    }
