"""Baseline without memory: the nearest object."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import TARGETS, Scores, TargetEstimate, best_of


@TARGETS.register("nearest")
class Nearest:
    """The object whose surface is nearest to the hand."""

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Score each object by the smallest distance over its own."""
        distances = np.maximum(geometry.surface, 1e-6)
        scores = distances.min(initial=np.inf) / distances
        return TargetEstimate(best_of(scores), scores)
