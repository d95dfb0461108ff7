"""Baseline: a Gaussian mixture over whole reaches (Mainprice & Berenson 2013, IROS, 299-306).

A mixture over time and place together is fitted to demonstrated reaches, and a partial movement is
classified by the likelihood of its samples under the mixture of each class. The paper has a mixture
for each motion class; ours is one in the frame of the reach (``learned.reach_library``).
"""

from __future__ import annotations

import numpy as np

from igrip.targets import TARGETS, Scores
from igrip.targets._reach_classifier import ReachClassifier
from igrip.targets.learned.reach_library import ReachCoordinates, library_array

STEP = 1.0 / 30.0  # s; time that a sample stands for


@TARGETS.register("mixtures")
class Mixtures(ReachClassifier):
    """Classifies a movement by a Gaussian mixture over time and place."""

    def __init__(self) -> None:
        super().__init__(STEP)
        self._mean = library_array("mixture", "mean", shape=(-1, 3))
        parts = len(self._mean)
        precision = np.linalg.inv(library_array("mixture", "covariance", shape=(parts, 3, 3)))
        self._root = np.linalg.cholesky(precision)
        weight = library_array("mixture", "weight", shape=(parts,))
        self._log_weight = np.log(weight) + 0.5 * np.linalg.slogdet(precision)[1]

    def log_density(self, reach: ReachCoordinates) -> Scores:
        """Return the log density of the mixture at time and place."""
        at = np.column_stack([np.full(len(reach.place), reach.elapsed), reach.place])
        offset = np.einsum("okj,kji->oki", at[:, None] - self._mean, self._root)
        each = self._log_weight - 0.5 * (offset**2).sum(axis=2)
        density: Scores = np.logaddexp.reduce(each, axis=1)
        return density
