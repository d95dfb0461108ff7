"""Baseline: a Gaussian for each step of time (Pérez-D'Arpino & Shah 2015, ICRA, 6175-6182).

A library of demonstrated reaches gives mean and covariance of the place of the hand at each step
of time after the onset; the partial movement is classified by the product of these densities, over
equal priors. The paper aligns demonstrations by dynamic time warping and has one library for each
fixed place; ours is one library in the frame of the reach (``learned.reach_library``), on
unwarped time.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import TARGETS, Scores, TargetEstimate, best_of
from igrip.targets.learned.reach_library import (
    AccumulatedLikelihood,
    ReachFrames,
    library_array,
    log_volume,
)


class Gaussians:
    """Classifies a movement by Gaussians over time."""

    def __init__(self) -> None:
        self._step = float(library_array("gaussians", "step_s", shape=()))
        self._mean = library_array("gaussians", "mean", shape=(-1, 2))
        covariance = library_array("gaussians", "covariance", shape=(len(self._mean), 2, 2))
        self._precision = np.linalg.inv(covariance)
        self._log_size = 0.5 * np.linalg.slogdet(self._precision)[1]
        self._frames, self._likelihood = ReachFrames(), AccumulatedLikelihood(self._step)

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the object whose reach the movement so far fits best."""
        reach = self._frames.update(motion, geometry)
        if reach is None:
            probability = self._likelihood.probability(geometry)
            return TargetEstimate(best_of(probability), probability)
        k = min(round(reach.elapsed / self._step), len(self._mean) - 1)
        offset = reach.place - self._mean[k]
        fit = -0.5 * np.einsum("oi,ij,oj->o", offset, self._precision[k], offset)
        fit += self._log_size[k]
        probability = self._likelihood.add(geometry, reach, fit - log_volume(reach))
        return TargetEstimate(best_of(probability), probability)


TARGETS.register("gaussians")(Gaussians)
