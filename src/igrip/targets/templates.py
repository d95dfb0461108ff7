"""Baseline: kinematic template matching (Pasqual & Wobbrock 2014, CHI, 743-752).

The profile of speed so far is compared with the beginnings of a library of profiles; the one with
the smallest mean absolute difference, summed over the updates, gives the length of the movement.
That length along the present direction from the start is the predicted end, and the object nearest
to it the target.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import TARGETS, Scores, TargetEstimate, best_of
from igrip.targets.learned.reach_library import ReachFrames, library_array

Array = NDArray[np.float64]


class Templates:
    """Predicts the end of a movement from profiles of speed."""

    def __init__(self) -> None:
        self._step = float(library_array("templates", "step_s", shape=()))
        self._speeds = library_array("templates", "speed", shape=(-1, -1))
        self._distances = library_array("templates", "distance", shape=(len(self._speeds),))
        self._frames = ReachFrames()
        self._end: Array | None = None
        self._reset()

    def _reset(self) -> None:
        self._profile = [(0.0, 0.0)]  # time since onset, speed
        self._difference = np.zeros(len(self._distances))

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the object nearest to the predicted end."""
        reach = self._frames.update(motion, geometry)
        if reach is None:  # a hand that has stopped keeps its predicted end
            return self._nearest(self._end, geometry)
        if reach.begins or reach.elapsed < self._profile[-1][0]:
            self._reset()
        (position, velocity, _), start = motion.reach.now, motion.reach.start
        self._profile.append((reach.elapsed, float(np.linalg.norm(velocity))))
        known = np.array(self._profile)
        steps = min(1 + int(reach.elapsed / self._step), self._speeds.shape[1])
        so_far = np.interp(self._step * np.arange(steps), known[:, 0], known[:, 1])
        difference = np.abs(self._speeds[:, :steps] - so_far).mean(axis=1)
        self._difference += difference * reach.passed / self._step
        offset = position - start
        covered = max(float(np.linalg.norm(offset)), 1e-9)
        length = max(covered, self._distances[int(np.argmin(self._difference))])
        self._end = start + offset / covered * length
        return self._nearest(self._end, geometry)

    @staticmethod
    def _nearest(end: Array | None, geometry: Geometry) -> TargetEstimate:
        """Score each object by the smallest distance from the predicted end over its own."""
        if end is None or not geometry.objects:
            return TargetEstimate(None, np.zeros(len(geometry.objects)))
        distance = np.linalg.norm(geometry.cylinders().centre - end, axis=1)
        scores = distance.min() / np.maximum(distance, 1e-9)
        return TargetEstimate(best_of(scores), scores)


TARGETS.register("templates")(Templates)
