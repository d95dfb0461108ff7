"""A recursive posterior over the objects and none.

While a hand moves, the log-odds of each object are pooled: those believed so far, faded over a
short memory and with a small chance of a change of mind, and those that a learned scorer reads off
the movement (``learned.features``, ``learned.network``). A movement is seen
through much the same features from sample to sample, so its samples are no independent witnesses;
a product of likelihoods would be sure of itself far too soon. While a hand rests, nothing speaks
for an object: what is believed is kept and forgotten slowly in favour of none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np

from igrip.compiled import kernel
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.targets import TARGETS, Scores, TargetEstimate, best_of
from igrip.targets.learned.features import LOCAL, SHARED, describe
from igrip.targets.learned.network import Scorer, read_scorer

WEIGHTS = Path(__file__).with_name("learned") / "bayes.json"
CHANGE_OF_MIND = 0.1  # a second, guess
REST_MEMORY = 1.0  # s, time constant with which a resting hand's belief is forgotten; guess
NONE_AT_REST = 0.4  # what is then at least believed of none: it may be about to reach; guess
MAX_REST = 0.1  # s between two samples; what happened in a longer gap was not seen
NAMELESS = 0.97  # a moving hand has no target where none is likelier than this
UNLIKELY = 1e-6  # no object is ever ruled out for good


@kernel
def pool(belief, scores, keep, change):
    """Pool what was believed with what the scorer says, in place.

    ``log b' = keep · log((1 - change) b + change / (o + 1)) + (1 - keep) · score + constant``

    Parameters
    ----------
    belief : (o + 1,), changed
        Probability of each object and, last, of none.
    scores : (o,)
        Log-odds of each object against none.
    keep, change : float
        Part of the log-odds that is kept; probability that the aim has changed since.
    """
    last = len(belief) - 1
    highest = -math.inf
    for k in range(last + 1):
        prior = (1.0 - change) * belief[k] + change / (last + 1)
        score = scores[k] if k < last else 0.0
        belief[k] = keep * math.log(max(prior, 1e-300)) + (1.0 - keep) * score
        highest = max(highest, belief[k])
    total = 0.0
    for k in range(last + 1):
        belief[k] = math.exp(belief[k] - highest)
        total += belief[k]
    for k in range(last + 1):
        belief[k] = (belief[k] / total + UNLIKELY / (last + 1)) / (1.0 + UNLIKELY)


def resting(objects: int) -> Scores:
    """Return what is believed of a hand that has long been at rest, shape (objects + 1,)."""
    if not objects:
        return np.ones(1)
    none = max(NONE_AT_REST, 2.0 / (2.0 + objects))  # at least twice as likely as any one object
    return np.append(np.full(objects, (1.0 - none) / objects), none)


@cache
def default_scorer() -> Scorer:
    """Return the scorer that ships."""
    return read_scorer(WEIGHTS)


class Bayes:
    """Posterior of one hand.

    Parameters
    ----------
    scorer : Scorer, optional
        By default the one that ships.
    """

    def __init__(self, scorer: Scorer | None = None) -> None:
        self._scorer = scorer or default_scorer()
        self._ids: list[str] = []
        self._belief = resting(0)
        self._t = math.nan

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the probability of each object and of none.

        The target of a moving hand is the most probable object, unless none is likelier than 0.97:
        early in a reach much speaks for none, and yet which object it would be is often clear. A
        hand at rest has the target that is likelier than none.
        """
        moves = motion.reach.moving
        self._follow_objects([placed.id for placed in geometry.objects])
        objects = len(self._ids)
        passed = 0.0 if math.isnan(self._t) else motion.t - self._t
        self._t = motion.t
        belief = self._belief
        # a resting hand that stirs may begin to reach, or hold what it has reached and tremble
        held = objects > 0 and belief[:-1].max() > belief[-1]
        looks = moves or (motion.reach.stirs and not held)
        if looks and objects:
            local, shared = np.empty((objects, len(LOCAL))), np.empty(len(SHARED))
            describe(*motion.reach[1:], geometry.cylinders(), local, shared)
            keep = math.exp(-passed / self._scorer.memory)
            change = -math.expm1(-CHANGE_OF_MIND * passed)
            pool(belief, self._scorer.score(local, shared), keep, change)
        elif not looks:
            keep = math.exp(-min(passed, MAX_REST) / REST_MEMORY)
            belief[:] = keep * belief + (1.0 - keep) * resting(objects)
        best = best_of(belief[:-1])
        limit = NAMELESS if moves or best is None else float(belief[best])
        target = best if belief[-1] <= limit else None
        return TargetEstimate(target, belief[:-1].copy(), belief.copy())

    def _follow_objects(self, ids: list[str]) -> None:
        """Carry the belief over to the objects that are there now; what vanishes goes to none."""
        if ids == self._ids:
            return
        if not self._ids:
            self._ids, self._belief = ids, resting(len(ids))
            return
        known = dict(zip(self._ids, self._belief.tolist(), strict=False))
        objects = np.array([known.get(id, UNLIKELY) for id in ids])
        objects *= min(1.0, 1.0 / max(objects.sum(), UNLIKELY))
        self._ids, self._belief = ids, np.append(objects, max(0.0, 1.0 - objects.sum()))


TARGETS.register("bayes")(Bayes)
