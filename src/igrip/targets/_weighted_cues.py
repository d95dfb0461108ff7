"""Estimators from the paper's four cues: their weighted mean (Eqs. 6-9), or one alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from igrip.compiled import kernel
from igrip.cues import CUES, Cue
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import Scores, TargetEstimate, best_of

METRICS = ("impacts", "distance_derivative", "distance", "future_distance")


@kernel
def weighted_sum(
    a: Scores, b: Scores, c: Scores, d: Scores, weights: tuple[float, float, float, float]
) -> Scores:
    """Return the weighted sum of four arrays."""
    first, second, third, fourth = weights
    scores = np.empty(len(a))
    for o in range(len(scores)):
        scores[o] = first * a[o] + second * b[o] + third * c[o] + fourth * d[o]
    return scores


Weights = tuple[float, float]
"""w_0 for cues of order 0 (the distances) and w_1 for those of order 1."""


class WeightedCues:
    """Weighted mean of the four metrics.

    Parameters
    ----------
    weights : function
        ``(speed, window_peak_speed) → (w_0, w_1)``, see :class:`igrip.motion.trajectory.Motion`.
    """

    def __init__(self, weights: Callable[[float, float | None], Weights]) -> None:
        self._weights = weights
        self._cues: list[Cue] = [CUES.get(name) for name in METRICS]

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the object with the highest ``c_glob = Σ w c / Σ w``."""
        by_order = self._weights(motion.speed, motion.window_peak_speed)
        weights = [by_order[metric.order] for metric in self._cues]
        total = sum(weights)
        scores: Scores = weighted_sum(
            *[cues[name] for name in METRICS], tuple([weight / total for weight in weights])
        )
        return TargetEstimate(best_of(scores), scores)


class SingleCue:
    """One cue alone decides, for comparison (paper: Eq. 10)."""

    def __init__(self, name: str) -> None:
        self._name = name

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the object with the highest score of this cue."""
        return TargetEstimate(best_of(cues[self._name]), cues[self._name])
