"""Baseline without memory: the object in the direction of the hand."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import TARGETS, Scores, TargetEstimate, best_of

MIN_SPEED = 0.03  # m/s; a slower hand has no direction; as cues.min_speed


@TARGETS.register("heading")
class Heading:
    """The object whose middle lies best in the direction in which the hand moves."""

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Score each object by the cosine of the angle, from 0 (behind) to 1 (ahead)."""
        if motion.speed < MIN_SPEED or not geometry.objects:
            return TargetEstimate(None, np.zeros(len(geometry.objects)))
        towards = geometry.cylinders().centre - motion.position
        distance = np.maximum(np.linalg.norm(towards, axis=1), 1e-9)
        scores = 0.5 + 0.5 * (towards @ motion.velocity) / (distance * motion.speed)
        return TargetEstimate(best_of(scores), scores)
