"""Baselines without a memory: the nearest object, and the object in the direction of the hand."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from igrip.geometry import cylinder
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets.base import TARGETS, Belief, Scores, best_of

LEAST_SPEED = 0.03  # m/s: slower, a hand has no direction; as cues.least_speed


class Nearest:
    """The object whose surface is nearest to the hand."""

    def update(self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]) -> Belief:
        """Score each object by the least distance over its own."""
        distances = np.maximum(geometry.surface, 1e-6)
        scores = distances.min(initial=np.inf) / distances
        return Belief(best_of(scores), scores)


class Heading:
    """The object whose middle lies best in the direction in which the hand moves."""

    def update(self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]) -> Belief:
        """Score each object by the cosine of the angle, from 0 (behind) to 1 (ahead)."""
        if motion.speed < LEAST_SPEED or not geometry.objects:
            return Belief(None, np.zeros(len(geometry.objects)))
        towards = geometry.cylinders()[:, cylinder.MIDDLE : cylinder.AXIS] - motion.position
        away = np.maximum(np.linalg.norm(towards, axis=1), 1e-9)
        scores = 0.5 + 0.5 * (towards @ motion.velocity) / (away * motion.speed)
        return Belief(best_of(scores), scores)


TARGETS.register("nearest")(Nearest)
TARGETS.register("heading")(Heading)
