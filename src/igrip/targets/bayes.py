"""A recursive posterior over the objects and none.

While a hand moves, two log-odds of each object are pooled: those of the posterior so far, faded
over a short memory and with a small probability of a switch of target, and those that a learned
scorer computes from the movement (``learned.features``, ``learned.network``). The features of
successive samples are much alike, so samples are not independent; a product of likelihoods would be
overconfident far too soon. While a hand rests, there is no evidence for any object: the posterior
decays slowly towards that of a resting hand (docs/decisions/0006-pooled-posterior.md).
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
from igrip.targets.learned.familiarity import Familiarity
from igrip.targets.learned.features import features_of
from igrip.targets.learned.network import Scorer, read_scorer

WEIGHTS = Path(__file__).with_name("learned") / "bayes.json"
SWITCH_RATE = 0.1  # 1/s; rate at which a hand switches to another target; guess
REST_TIME_CONSTANT = 1.0  # s; decay of the posterior of a resting hand; guess
MIN_NONE_AT_REST = 0.4  # probability of none of a resting hand: it may be about to reach; guess
MAX_REST_STEP = 0.1  # s; a longer gap between two samples counts as this, since it was not observed
MAX_NONE = 0.97  # a moving hand has no target if none is likelier than this
FLOOR = 1e-6  # probability that all objects keep together: none is ever ruled out permanently


@kernel
def pool(posterior, scores, keep, switch):
    """Pool the posterior with the scorer's log-odds, in place.

    ``log p' = keep · log((1 - switch) p + switch / (o + 1)) + (1 - keep) · score + constant``

    Parameters
    ----------
    posterior : (o + 1,), changed
        Probability of each object and, last, of none.
    scores : (o,)
        Log-odds of each object against none.
    keep, switch : float
        Weight of the posterior's log-odds; probability that the target has changed since.
    """
    last = len(posterior) - 1
    highest = -math.inf
    for k in range(last + 1):
        prior = (1.0 - switch) * posterior[k] + switch / (last + 1)
        score = scores[k] if k < last else 0.0
        posterior[k] = keep * math.log(max(prior, 1e-300)) + (1.0 - keep) * score
        highest = max(highest, posterior[k])
    total = 0.0
    for k in range(last + 1):
        posterior[k] = math.exp(posterior[k] - highest)
        total += posterior[k]
    for k in range(last + 1):
        posterior[k] = (posterior[k] / total + FLOOR / (last + 1)) / (1.0 + FLOOR)


def resting_posterior(objects: int) -> Scores:
    """Return the posterior of a hand that has long been at rest, shape (objects + 1,)."""
    if not objects:
        return np.ones(1)
    # at least twice as likely as any one object
    none = max(MIN_NONE_AT_REST, 2.0 / (2.0 + objects))
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
        self._posterior = resting_posterior(0)
        self._t = math.nan
        self._familiarity = Familiarity()

    def update(
        self, motion: Motion, geometry: Geometry, cues: Mapping[str, Scores]
    ) -> TargetEstimate:
        """Return the probability of each object and of none.

        The target of a moving hand is the most probable object, unless none is likelier than 0.97:
        early in a reach none is often likely although the best object is clear. A hand at rest has
        a target only if that is likelier than none.
        """
        moving = motion.reach.moving
        self._follow_objects([placed.id for placed in geometry.objects])
        objects = len(self._ids)
        passed = 0.0 if math.isnan(self._t) else motion.t - self._t
        self._t = motion.t
        posterior = self._posterior
        # a resting hand that may move begins a reach, or trembles at the object it has reached
        arrived = objects > 0 and posterior[:-1].max() > posterior[-1]
        observed = moving or (motion.reach.may_move and not arrived)
        if observed and objects:
            features = features_of(motion.reach, geometry.cylinders())
            self._familiarity.update(motion.t, features.shared)
            scores = self._scorer.score(features)
            keep = math.exp(-passed / self._scorer.memory)
            pool(posterior, scores, keep, -math.expm1(-SWITCH_RATE * passed))
        elif not observed:
            keep = math.exp(-min(passed, MAX_REST_STEP) / REST_TIME_CONSTANT)
            posterior[:] = keep * posterior + (1.0 - keep) * resting_posterior(objects)
            self._familiarity.reset()
        best = best_of(posterior[:-1])
        limit = MAX_NONE if moving or best is None else float(posterior[best])
        target = best if posterior[-1] <= limit else None
        return TargetEstimate(
            target, posterior[:-1].copy(), posterior.copy(), self._familiarity.value
        )

    def _follow_objects(self, ids: list[str]) -> None:
        """Carry the posterior over to the present objects; that of vanished ones goes to none."""
        if ids == self._ids:
            return
        if not self._ids:
            self._ids, self._posterior = ids, resting_posterior(len(ids))
            return
        known = dict(zip(self._ids, self._posterior.tolist(), strict=False))
        objects = np.array([known.get(id, FLOOR) for id in ids])
        objects *= min(1.0, 1.0 / max(objects.sum(), FLOOR))
        self._ids, self._posterior = ids, np.append(objects, max(0.0, 1.0 - objects.sum()))


TARGETS.register("bayes")(Bayes)
