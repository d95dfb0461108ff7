"""Onset and end of a movement, from a trace that no estimator has touched."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.signal import butter, sosfiltfilt

Array = NDArray[np.float64]
PART_OF_PEAK = 0.10
OUTLIER_WINDOW = 5  # samples: up to two wrong ones in a row are no movement
MAX_GAPS = 20.0  # times as long as its samples would last without gaps
PADDING = 15  # samples at both ends of the filter
CUTOFF = 6.0  # Hz of the zero-phase filter; reaching is below it (Winter 2009, Biomechanics)


def movement_bounds(times: Array, speeds: Array, noisy: bool = False) -> tuple[float, float] | None:
    """Return onset and end of the one movement in a trace of speeds [s].

    Onset: first sample before the peak that is faster than 10 % of it. End: first sample after it
    that is slower than the lowest speed after it plus 10 % of what the peak exceeds that by.

    Parameters
    ----------
    times, speeds : (n,)
        Increasing times [s], and speeds of the hand [m/s].
    noisy : bool
        Whether the trace is measured: noise at rest then passes 10 % of the peak now and again, so
        the *last* time that the speed rises above it before the peak is the onset. (Of a reach
        with a stop on the way that is only the second part.)

    Returns
    -------
    (float, float) or None
        None where the trace does not hold a peak between two slower parts.
    """
    if len(speeds) < 3 or not np.isfinite(speeds).all():
        return None
    peak = int(np.argmax(speeds))
    before = np.flatnonzero(speeds[:peak] > PART_OF_PEAK * speeds[peak])
    after = speeds[peak + 1 :]
    if not len(before) or not len(after):
        return None
    min_after = float(after.min())
    slow = np.flatnonzero(after < min_after + PART_OF_PEAK * (speeds[peak] - min_after))
    if not len(slow):
        return None
    if noisy:
        below = np.flatnonzero(speeds[:peak] <= PART_OF_PEAK * speeds[peak])
        before = before[before > below[-1]] if len(below) else before
        if not len(before):
            return None
    return float(times[before[0]]), float(times[peak + 1 + slow[0]])


def smooth_positions(times: Array, positions: Array) -> tuple[Array, Array]:
    """Return a raw trace after a median filter and a zero-phase low-pass, on even times.

    From increasing times (n,) [s] and positions (n, 3) [m], whose gaps are bridged by straight
    lines, to times (m,) [s] and positions (m, 3) [m] at the median rate of the trace; both are
    empty where the trace is too short to filter, or nearly all of its time is a gap.
    """
    nothing = np.empty(0), np.empty((0, 3))
    if len(times) < 3:
        return nothing
    step = float(np.median(np.diff(times)))
    if not step > 0.0 or times[-1] - times[0] > MAX_GAPS * step * len(times):
        return nothing
    even = times[0] + step * np.arange(int(np.floor((times[-1] - times[0]) / step + 1e-9)) + 1)
    usual = median_filter(positions, size=(OUTLIER_WINDOW, 1), mode="mirror")
    points = np.stack([np.interp(even, times, usual[:, axis]) for axis in range(3)], axis=1)
    if len(even) <= PADDING:
        return nothing
    sections = butter(2, min(CUTOFF, 0.45 / step), fs=1.0 / step, output="sos")
    return even, sosfiltfilt(sections, points, axis=0, padlen=PADDING)


def smooth_speeds(times: Array, positions: Array) -> tuple[Array, Array]:
    """Return times and speeds (m,) of what :func:`smooth_positions` returns [s, m/s]."""
    even, smooth = smooth_positions(times, positions)
    if not len(even):
        return even, np.empty(0)
    step = float(np.median(np.diff(times)))
    return even, np.linalg.norm(np.gradient(smooth, step, axis=0), axis=1)
