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
from igrip.targets.learned.reach_library import Follower, Witness, learned, log_volume


class Gaussians:
    """Classifies a movement by Gaussians over time."""

    def __init__(self) -> None:
        self._step = float(learned("gaussians", "step_s", shape=()))
        self._mean = learned("gaussians", "mean", shape=(-1, 2))
        covariance = learned("gaussians", "covariance", shape=(len(self._mean), 2, 2))
        self._precision = np.linalg.inv(covariance)
        self._log_size = 0.5 * np.linalg.slogdet(self._precision)[1]
        self._follower, self._witness = Follower(), Witness(self._step)

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the object whose reach the movement so far fits best."""
        seen = self._follower.update(motion, geometry)
        if seen is None:
            shares = self._witness.shares(geometry)
            return TargetEstimate(best_of(shares), shares)
        k = min(round(seen.elapsed / self._step), len(self._mean) - 1)
        off = seen.place - self._mean[k]
        fit = -0.5 * np.einsum("oi,ij,oj->o", off, self._precision[k], off) + self._log_size[k]
        shares = self._witness.hear(geometry, seen, fit - log_volume(seen))
        return TargetEstimate(best_of(shares), shares)


TARGETS.register("gaussians")(Gaussians)
