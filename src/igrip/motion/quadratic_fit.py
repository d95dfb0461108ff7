"""Weighted least squares of degree 2 through the recent trajectory, in closed form."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

Array = NDArray[np.float64]


@kernel
def fit_quadratic(times: Array, positions: Array, coefficients: Array) -> bool:
    """Fit ``p(s) = c0 + c1 s + c2 s²`` to each axis, s the time since the newest sample.

    Minimises ``Σ w · residual²`` with ``w = 1 / (1 + τ)``, τ = -s in seconds (paper: Eq. 1).
    Time is centred on now; with absolute clock times the normal equations would lose centimetres.

    Parameters
    ----------
    times : (n,) float64
        Increasing times of measurement [s]; the last one is "now".
    positions : (n, 3) float64
        Positions [m].
    coefficients : (3, 3) float64, written
        Row d holds c_d of the three axes [m, m/s, m/s²].

    Returns
    -------
    bool
        False, with nothing written, where the samples do not determine a parabola.
    """
    n = times.shape[0]
    if n < 3:
        return False
    now = times[n - 1]
    span = now - times[0]
    if not span > 0.0:
        return False
    # s is measured in units of the span: the moments then lie in [0, n] and the system is tame.
    m0 = m1 = m2 = m3 = m4 = 0.0
    b = np.zeros((3, 3))
    for k in range(n):
        tau = now - times[k]
        w = 1.0 / (1.0 + tau)
        s = -tau / span
        ws = w * s
        wss = ws * s
        m0 += w
        m1 += ws
        m2 += wss
        m3 += wss * s
        m4 += wss * s * s
        for axis in range(3):
            # relative to the newest position, so that a far-off origin costs no digits
            y = positions[k, axis] - positions[n - 1, axis]
            b[0, axis] += w * y
            b[1, axis] += ws * y
            b[2, axis] += wss * y
    c00 = m2 * m4 - m3 * m3
    c01 = m2 * m3 - m1 * m4
    c02 = m1 * m3 - m2 * m2
    c11 = m0 * m4 - m2 * m2
    c12 = m1 * m2 - m0 * m3
    c22 = m0 * m2 - m1 * m1
    determinant = m0 * c00 + m1 * c01 + m2 * c02
    if not determinant > 1e-12 * m0 * m2 * m4:
        return False
    for axis in range(3):
        y0, y1, y2 = b[0, axis], b[1, axis], b[2, axis]
        coefficients[0, axis] = (
            positions[n - 1, axis] + (c00 * y0 + c01 * y1 + c02 * y2) / determinant
        )
        coefficients[1, axis] = (c01 * y0 + c11 * y1 + c12 * y2) / determinant / span
        coefficients[2, axis] = (c02 * y0 + c12 * y1 + c22 * y2) / determinant / (span * span)
    return True


@kernel
def follow(coefficients: Array, steps: Array, future: Array, velocity: Array) -> float:
    """Follow the parabola; return the speed at s = 0 [m/s].

    Parameters
    ----------
    coefficients : (3, 3)
        As :func:`fit_quadratic` writes them.
    steps : (m,)
        Times s from now on [s].
    future, velocity : (m, 3), written
        Position and velocity at these times [m, m/s].
    """
    speed2 = 0.0
    for axis in range(3):
        c0, c1, c2 = coefficients[0, axis], coefficients[1, axis], coefficients[2, axis]
        speed2 += c1 * c1
        for k in range(steps.shape[0]):
            s = steps[k]
            future[k, axis] = c0 + s * (c1 + s * c2)
            velocity[k, axis] = c1 + 2.0 * s * c2
    speed: float = np.sqrt(speed2)
    return speed


@kernel
def predict(
    times: Array, positions: Array, steps: Array,
    coefficients: Array, future: Array, velocity: Array,
) -> float:  # fmt: skip
    """Fit, then follow, in one call: :func:`fit_quadratic`, :func:`follow`; NaN: not determined."""
    if not fit_quadratic(times, positions, coefficients):
        return math.nan
    speed: float = follow(coefficients, steps, future, velocity)
    return speed
