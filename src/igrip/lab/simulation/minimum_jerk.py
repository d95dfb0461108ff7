"""The path of an undisturbed reach (Flash & Hogan 1985, J. Neuroscience 5:1688-1703)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def progress(part: Array) -> Array:
    """Return how much of the way is done after a part of the duration, both in [0, 1].

    ``10 s³ - 15 s⁴ + 6 s⁵``: at rest at both ends, with the least jerk in between.
    """
    s = np.clip(part, 0.0, 1.0)
    done: Array = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    return done


def reach(start: Array, end: Array, lift: float, part: Array) -> Array:
    """Return points of a reach that rises above the straight line on its way, (n, 3) [m].

    From ``start`` to ``end``, (3,) [m], with a height of ``lift`` over the line at its middle [m],
    at parts (n,) of the duration.
    """
    done = progress(part)[:, None]
    arc = 4.0 * lift * done * (1.0 - done) * np.array([0.0, 0.0, 1.0])
    points: Array = start + (end - start) * done + arc
    return points
