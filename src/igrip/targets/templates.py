"""Baseline: kinematic template matching (Pasqual & Wobbrock 2014, CHI, 743-752).

The profile of speed so far is compared with the beginnings of a library of profiles; the one with
the least mean absolute difference, summed over the updates, says how far the whole movement goes.
That distance along the present direction from the start is the predicted end, and the object next
to it the target.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from igrip.geometry import cylinder
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import TARGETS, Scores, TargetEstimate, best_of
from igrip.targets.learned.reach_library import Follower, learned

Array = NDArray[np.float64]


class Templates:
    """Predicts the end of a movement from profiles of speed."""

    def __init__(self) -> None:
        self._step = float(learned("templates", "step_s", shape=()))
        self._speeds = learned("templates", "speed", shape=(-1, -1))
        self._distances = learned("templates", "distance", shape=(len(self._speeds),))
        self._follower = Follower()
        self._end: Array | None = None
        self._begin()

    def _begin(self) -> None:
        self._profile = [(0.0, 0.0)]
        self._apart = np.zeros(len(self._distances))

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the object next to the predicted end."""
        seen = self._follower.update(motion, geometry)
        if seen is None:  # a hand that has stopped keeps the end that was predicted
            return self._next_to(self._end, geometry)
        if seen.begins or seen.elapsed < self._profile[-1][0]:
            self._begin()
        now, start = motion.reach.now, motion.reach.start
        self._profile.append((seen.elapsed, float(np.linalg.norm(now[3:6]))))
        known = np.array(self._profile)
        steps = min(1 + int(seen.elapsed / self._step), self._speeds.shape[1])
        so_far = np.interp(self._step * np.arange(steps), known[:, 0], known[:, 1])
        difference = np.abs(self._speeds[:, :steps] - so_far).mean(axis=1)
        self._apart += difference * seen.passed / self._step
        way = now[:3] - start
        length = max(float(np.linalg.norm(way)), 1e-9)
        whole = max(length, self._distances[int(np.argmin(self._apart))])
        self._end = start + way / length * whole
        return self._next_to(self._end, geometry)

    @staticmethod
    def _next_to(end: Array | None, geometry: Geometry) -> TargetEstimate:
        """Score each object by the least distance from the predicted end over its own."""
        if end is None or not geometry.objects:
            return TargetEstimate(None, np.zeros(len(geometry.objects)))
        away = np.linalg.norm(
            geometry.cylinders()[:, cylinder.MIDDLE : cylinder.AXIS] - end, axis=1
        )
        scores = away.min() / np.maximum(away, 1e-9)
        return TargetEstimate(best_of(scores), scores)


TARGETS.register("templates")(Templates)
