"""Baseline: a Gaussian for each step of time (Pérez-D'Arpino & Shah 2015, ICRA, 6175-6182).

A library of demonstrated reaches gives mean and covariance of the place of the hand at each step
of time after the onset; the partial movement is classified by the product of these densities, over
equal priors. The paper aligns demonstrations by dynamic time warping and has one library for each
fixed place; ours is one library in the frame of the reach (``learned.reach_library``), on
unwarped time.
"""

from __future__ import annotations

import numpy as np

from igrip.targets import TARGETS, Scores
from igrip.targets._reach_classifier import ReachClassifier
from igrip.targets.learned.reach_library import ReachCoordinates, library_array


@TARGETS.register("gaussians")
class Gaussians(ReachClassifier):
    """Classifies a movement by Gaussians over time."""

    def __init__(self) -> None:
        self._step = float(library_array("gaussians", "step_s", shape=()))
        super().__init__(self._step)
        self._mean = library_array("gaussians", "mean", shape=(-1, 2))
        covariance = library_array("gaussians", "covariance", shape=(len(self._mean), 2, 2))
        self._precision = np.linalg.inv(covariance)
        self._log_size = 0.5 * np.linalg.slogdet(self._precision)[1]

    def log_density(self, reach: ReachCoordinates) -> Scores:
        """Return the log density of the Gaussian of this time."""
        k = min(round(reach.elapsed / self._step), len(self._mean) - 1)
        offset = reach.place - self._mean[k]
        density: Scores = -0.5 * np.einsum("oi,ij,oj->o", offset, self._precision[k], offset)
        density += self._log_size[k]
        return density
