"""Classifiers of a movement by a density in the frame of the reach, accumulated over time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import Scores, TargetEstimate, best_of
from igrip.targets.learned.reach_library import (
    AccumulatedLikelihood,
    ReachCoordinates,
    ReachFrames,
    log_volume,
)


class ReachClassifier(ABC):
    """Returns the object under whose reach the samples so far are likeliest.

    Parameters
    ----------
    step : float
        Time that a sample stands for [s].
    """

    def __init__(self, step: float) -> None:
        self._frames, self._likelihood = ReachFrames(), AccumulatedLikelihood(step)

    @abstractmethod
    def log_density(self, reach: ReachCoordinates) -> Scores:
        """Return the log density of the present sample for each object, in its reach's frame."""

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the likeliest object; where no reach goes on, as it was."""
        reach = self._frames.update(motion, geometry)
        if reach is None:
            probability = self._likelihood.probability(geometry)
        else:
            density = self.log_density(reach) - log_volume(reach)
            probability = self._likelihood.add(geometry, reach, density)
        return TargetEstimate(best_of(probability), probability)
