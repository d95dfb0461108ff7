"""Targets estimators: one instance per hand, from cues to an estimate of the target."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.registry import Registry

Scores = NDArray[np.float64]


class TargetEstimate(NamedTuple):
    """Estimate of the target of one hand. Arrays in the order of the objects.

    Attributes
    ----------
    target : int or None
        Index of the target; None: no decision.
    scores : (o,)
        The scores by which it was chosen.
    probability : (o + 1,) or None
        Probability of each object and, last, of none; None if the scores are not calibrated.
    familiarity : float or None
        How like the movements it learned from this one is, from 0 to 1; None if it learned from
        none, or the hand rests.
    """

    target: int | None
    scores: Scores
    probability: Scores | None = None
    familiarity: float | None = None


class HandEstimate(NamedTuple):
    """What is known of one hand after a frame, before hands are looked at together.

    Attributes
    ----------
    id : str
        Of the hand.
    motion : Motion
        Of the hand.
    geometry : Geometry
        The hand against every object.
    estimate : TargetEstimate
        Its own, as if there were no other hand.
    """

    id: str
    motion: Motion
    geometry: Geometry
    estimate: TargetEstimate


class TargetsEstimator(Protocol):
    """Estimates the target of one hand; may remember earlier frames."""

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the estimate after a frame, from the hand's motion, geometry and cue scores."""
        ...


TARGETS: Registry[Callable[[], TargetsEstimator]] = Registry("targets estimator", "igrip.targets")
TIE = 1e-12


def best_of(scores: Scores) -> int | None:
    """Return the index of the highest score; None where it is ≤ 0 or shared (decision 0013)."""
    values = scores.tolist()  # a few numbers: plain Python is done before numpy has begun
    highest = max(values, default=0.0)
    if not highest > 0.0 or any(map(math.isnan, values)):
        return None
    best = [o for o, value in enumerate(values) if value >= highest - TIE]
    return best[0] if len(best) == 1 else None
