"""The paper's estimator: the object with the highest weighted mean of the cues (Eqs. 6-9)."""

from __future__ import annotations

from functools import partial

from igrip.targets import TARGETS
from igrip.targets._weighted_cues import WeightedCues, Weights


def paper_weights(speed: float, window_peak_speed: float | None) -> Weights:
    """Return w_0 and w_1 of the paper (Eqs. 6, 7), corrected (docs/decisions/0013).

    The peak is that of the window *before* the current sample; with the sample inside, it could
    never be exceeded. Without an earlier sample, or with both speeds zero, both weights are 1.
    """
    if window_peak_speed is None or max(speed, window_peak_speed) == 0.0:
        return 1.0, 1.0
    return speed / max(speed, window_peak_speed), 2.0 if speed > window_peak_speed else 1.0


TARGETS.register("paper")(partial(WeightedCues, paper_weights))
