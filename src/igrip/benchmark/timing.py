"""Times of several contestants, taken in turn, so that a slower moment slows them all."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Work = Callable[[int], object]


def interleaved(
    contestants: Mapping[str, Work], frames: Sequence[int], turn: int = 1, least: float = 0.0
) -> dict[str, NDArray[np.float64]]:
    """Time each contestant on each frame, in turn.

    Parameters
    ----------
    contestants : mapping of str to function
        Each is called with the number of a frame.
    frames : sequence of int
        The frames, in order.
    turn : int
        Frames that one contestant does in a row. With 1 each finds the processor's caches full of
        what the others left; with more, its own ("hot").
    least : float
        Length of a turn [s]: the rest of it is slept through (a cadence). 0: none.

    Returns
    -------
    dict of str to (n,) float64
        Seconds of each call.
    """
    times: dict[str, list[float]] = {name: [] for name in contestants}
    clock = time.perf_counter
    gc.collect()
    gc.disable()  # a collection in the middle would be charged to whoever runs then
    try:
        for first in range(0, len(frames), turn):
            begin = clock()
            for name, work in contestants.items():
                for frame in frames[first : first + turn]:
                    before = clock()
                    work(frame)
                    times[name].append(clock() - before)
            left = begin + least - clock()
            if left > 0.0:
                time.sleep(left)
    finally:
        gc.enable()
    return {name: np.array(seconds) for name, seconds in times.items()}


def milliseconds(seconds: NDArray[np.float64]) -> dict[str, float]:
    """Return the median and the 99th percentile [ms]."""
    return {
        "p50_ms": float(np.median(seconds)) * 1e3,
        "p99_ms": float(np.quantile(seconds, 0.99)) * 1e3,
    }
