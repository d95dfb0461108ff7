"""The paper's estimator with weights that let the distances count to the end."""

from __future__ import annotations

from functools import partial

from igrip.targets import TARGETS
from igrip.targets._weighted_cues import WeightedCues, Weights


def repaired_weights(speed: float, window_peak_speed: float | None) -> Weights:
    """Return w_0 = 1 and w_1 = min(v / v_max_win, 2): the distances count to the end."""
    if window_peak_speed is None or max(speed, window_peak_speed) == 0.0:
        return 1.0, 1.0
    return 1.0, min(speed / window_peak_speed, 2.0) if window_peak_speed > 0.0 else 2.0


TARGETS.register("repaired")(partial(WeightedCues, repaired_weights))
