"""How far round a thing was seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def degrees_covered(yaws: Sequence[float], arc: float) -> float:
    """Return how much of a full turn views see.

    Parameters
    ----------
    yaws : sequence of float
        Of the views [rad].
    arc : float
        That each counts for [degrees].

    Returns
    -------
    float
        At most 360 [degrees].
    """
    angles = np.sort(np.degrees(np.asarray(yaws, dtype=np.float64)) % 360.0)
    if not len(angles):
        return 0.0
    gaps = np.diff(np.append(angles, angles[0] + 360.0))
    return float(np.minimum(gaps, arc).sum())
