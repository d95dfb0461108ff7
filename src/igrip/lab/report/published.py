"""Results of the i-GRIP paper, to stand beside ours (its Table I and Sec. Results)."""

from __future__ import annotations

from typing import NamedTuple


class Published(NamedTuple):
    """One row of the paper's Table I: parts of frames and trials, delay and margin [s]."""

    frames: float
    success: float
    delay_s: float
    margin_s: float


TABLE_I = {
    "paper": Published(0.619, 0.899, 0.52, 0.67),
    "distance_derivative": Published(0.568, 0.720, 0.48, 0.72),
    "impacts": Published(0.157, 0.347, 0.97, 0.25),
    "distance": Published(0.536, 0.882, 0.59, 0.60),
    "future_distance": Published(0.596, 0.887, 0.52, 0.58),
}
GRIP = Published(float("nan"), 0.948, 0.39, 0.80)
VALID_SHARE, OBSERVED_SHARE = 1553 / 2718, 0.894
CONDITIONS = {
    "ipsi": (0.905, 0.955), "contra": (0.894, 0.942),
    "executed": (0.929, 0.947), "simulated": (0.868, 0.949),
}  # fmt: skip
"""Trial success of target and grip by side of the camera and by movement."""
