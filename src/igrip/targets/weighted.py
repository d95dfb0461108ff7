"""The paper's estimator: the object with the highest weighted mean of the cues (Eqs. 6-9)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from igrip.compiled import kernel
from igrip.cues import CUES, Cue
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets.base import TARGETS, Belief, Scores, best_of

METRICS = ("impacts", "distance_derivative", "distance", "future_distance")


@kernel
def add(part: Scores, weight: float, total: Scores) -> None:
    """Add ``weight`` times the part to the total, in place."""
    for o in range(len(total)):
        total[o] += weight * part[o]


Weights = tuple[float, float]
"""w_0 for cues of order 0 (the distances) and w_1 for those of order 1."""


def paper_weights(speed: float, window_peak_speed: float | None) -> Weights:
    """Return w_0 and w_1 of the paper (Eqs. 6, 7), its slips mended (SPEC §5).

    The peak is that of the window *before* the current sample; with the sample inside, it could
    never be exceeded. Without an earlier sample, or with both speeds zero, both weights are 1.
    """
    if window_peak_speed is None or max(speed, window_peak_speed) == 0.0:
        return 1.0, 1.0
    return speed / max(speed, window_peak_speed), 2.0 if speed > window_peak_speed else 1.0


def repaired_weights(speed: float, window_peak_speed: float | None) -> Weights:
    """Return w_0 = 1 and w_1 = min(v / v_max_win, 2): the distances keep their say to the end."""
    if window_peak_speed is None or max(speed, window_peak_speed) == 0.0:
        return 1.0, 1.0
    return 1.0, min(speed / window_peak_speed, 2.0) if window_peak_speed > 0.0 else 2.0


class WeightedCues:
    """Weighted mean of the four metrics.

    Parameters
    ----------
    weights : function
        From the speed and the peak speed of the window before it to w_0 and w_1.
    """

    def __init__(self, weights: Callable[[float, float | None], Weights]) -> None:
        self._weights = weights
        self._cues: list[Cue] = [CUES.get(name) for name in METRICS]

    def update(self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]) -> Belief:
        """Return the object with the highest ``c_glob = Σ w c / Σ w``."""
        by_order = self._weights(motion.speed, motion.window_peak_speed)
        weights = [by_order[metric.order] for metric in self._cues]
        total = sum(weights)
        scores = np.zeros(len(geometry.objects))
        for metric, weight in zip(self._cues, weights, strict=True):
            add(cues[metric.name], weight / total, scores)
        return Belief(best_of(scores), scores)


class SingleCue:
    """One cue alone decides, for comparison (paper: Eq. 10)."""

    def __init__(self, name: str) -> None:
        self._name = name

    def update(self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]) -> Belief:
        """Return the object with the highest score of this cue."""
        return Belief(best_of(cues[self._name]), cues[self._name])


TARGETS.register("paper")(partial(WeightedCues, paper_weights))
TARGETS.register("repaired")(partial(WeightedCues, repaired_weights))
for _name in METRICS:
    TARGETS.register(_name)(partial(SingleCue, _name))
