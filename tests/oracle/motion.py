"""Weighted quadratic regression, the predicted points and the speeds of a window (paper: Eq. 1)."""

from __future__ import annotations

import numpy as np


def fit(times, positions):
    """Return (3, 3) rows c0, c1, c2 that minimise sum w * residual**2, w = 1 / (1 + tau)."""
    times = np.asarray(times, dtype=float)
    s = times - times[-1]
    root = np.sqrt(1.0 / (1.0 - s))
    design = np.stack([np.ones_like(s), s, s**2], axis=1)
    return np.linalg.lstsq(design * root[:, None], positions * root[:, None], rcond=None)[0]


def future(coefficients, points, horizon):
    """Return predicted positions and velocities at ``points`` even steps up to ``horizon``."""
    s = horizon * np.arange(1, points + 1)[:, None] / points
    c0, c1, c2 = coefficients
    return c0 + c1 * s + c2 * s**2, c1 + 2.0 * c2 * s


def window_of(times, k, size, duration):
    """Return the indices of the window that ends at sample k."""
    first = max(0, k + 1 - size)
    return [i for i in range(first, k + 1) if times[i] >= times[k] - duration]


def motions(times, filtered, *, size, duration):
    """Return for each sample None or (coefficients, speed, highest earlier speed of the window)."""
    speeds, result = [None] * len(times), []
    for k in range(len(times)):
        window = window_of(times, k, size, duration)
        if len(window) < 3:
            result.append(None)
            continue
        coefficients = fit(np.asarray(times)[window], np.asarray(filtered)[window])
        earlier = [speeds[i] for i in window[:-1] if speeds[i] is not None]
        speeds[k] = float(np.linalg.norm(coefficients[1]))
        result.append((coefficients, speeds[k], max(earlier, default=None)))
    return result
