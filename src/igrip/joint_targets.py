"""Targets of two hands together, where their beliefs contend for one object.

Each hand has a posterior of its own (:mod:`igrip.targets`). Their product says that the hands
choose independently, which is wrong where both may be going for the same object: a thing that is
too wide for one hand is taken by both or by none, and a thing that one hand can take is seldom
taken by both. So the product is multiplied by ``ψ(i, j)`` for targets i and j, with

- ``ψ = BOTH`` where both take one wide object,
- ``ψ = ALONE`` where one hand takes a wide object and the other does not,
- ``ψ = SHARED`` where both take one object that a hand can take alone,

and 1 elsewhere. Each hand's marginal of the joint posterior over pairs of targets follows in closed
form; for one object w that they contend for, with ``q = p_B(w)``::

    p'_A(w) ∝ p_A(w) · (ψ(w, w) q + ψ(w, other) (1 - q))
    p'_A(j) ∝ p_A(j) · (ψ(j, w) q + (1 - q))

Hands that do not contend are independent, and their estimates are left as they are to the last bit.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from weakref import WeakKeyDictionary

import numpy as np

from igrip.geometry.scene import PlacedObject
from igrip.grasps.opposition import MAX_OPENING
from igrip.objects.model import ObjectModel
from igrip.targets import HandEstimate, Scores, TargetEstimate, best_of

BOTH = 4.0  # of simultaneous reaches beside a wide thing, three in ten are for it; guess
ALONE = 0.07  # one in thirty is of one hand alone; guess
SHARED = 1.0  # see docs/two-hands.md
MIN_BELIEF = 0.05  # hands contend for what each believes to be its target at least so much; guess
FULL_BELIEF = 0.15  # from here on ψ counts in full; between the two in part, without a step; guess
MAX_AGE = 0.1  # s; an older estimate of another hand does not count; guess


_widths: WeakKeyDictionary[ObjectModel, float] = WeakKeyDictionary()


def smallest_extent(model: ObjectModel) -> float:
    """Return the smallest edge of a model's box in its object frame [m].

    What exceeds the opening of a hand (``MAX_OPENING``) in every direction is too wide for one.
    """
    if model not in _widths:
        points = model.vertices @ model.mesh_from_object[:3, :3]
        _widths[model] = float(np.ptp(points, axis=0).min())
    return _widths[model]


class JointTargets:
    """Joins the estimates of hands that contend for an object; leaves all others alone."""

    def __init__(self) -> None:
        self._newest: dict[str, HandEstimate] = {}  # own estimates, not joint ones
        self._ids: list[str] = []

    def update(
        self,
        hands: Sequence[HandEstimate],
        objects: Sequence[PlacedObject],
        followed: Collection[str],
    ) -> list[TargetEstimate]:
        """Return the estimates of a frame's hands.

        Parameters
        ----------
        hands : sequence of HandEstimate
            The hands that are seen in this frame.
        objects : sequence of PlacedObject
            In the order of the estimates.
        followed : collection of str
            Ids of all hands that are followed; those of others are forgotten.

        Returns
        -------
        list of TargetEstimate
            In the order of the hands; the very same one where a hand contends with no other. With
            three hands and more, each is corrected by every other that it contends with.
        """
        estimates = [hand.estimate for hand in hands]
        if len(followed) < 2:
            self._newest.clear()
            return estimates
        ids = [placed.id for placed in objects]
        if ids != self._ids:
            self._ids = ids
            self._newest.clear()
        for gone in self._newest.keys() - set(followed):
            del self._newest[gone]
        self._newest.update({hand.id: hand for hand in hands})
        for a, hand in enumerate(hands):
            if not hand.motion.reach.moving or hand.estimate.probability is None:
                continue
            for other in self._newest.values():
                if other.id != hand.id and hand.motion.t - other.motion.t <= MAX_AGE:
                    estimates[a] = _join(estimates[a], hand, other, objects)
        return estimates


def _join(
    estimate: TargetEstimate,
    hand: HandEstimate,
    other: HandEstimate,
    objects: Sequence[PlacedObject],
) -> TargetEstimate:
    """Return the estimate of a hand, corrected by another where the two contend.

    They contend for what both may take: the other still moves, or it has arrived. What has been
    moved lately is no longer to be chosen.
    """
    own, theirs = hand.estimate.probability, other.estimate.probability
    if own is None or theirs is None:
        return estimate
    least = np.minimum(own[:-1], theirs[:-1]).tolist()
    for o, belief in enumerate(least):
        if belief <= MIN_BELIEF or objects[o].path is not None:
            continue
        if other.motion.reach.moving or theirs[o] > theirs[-1]:
            strength = min(1.0, (belief - MIN_BELIEF) / (FULL_BELIEF - MIN_BELIEF))
            estimate = _correct(estimate, o, float(theirs[o]), objects[o].model, strength)
    return estimate


def _correct(
    estimate: TargetEstimate, o: int, q: float, model: ObjectModel, strength: float
) -> TargetEstimate:
    """Return the estimate of a hand while another takes object ``o`` with probability q."""
    wide = smallest_extent(model) > MAX_OPENING
    both, alone = (BOTH, ALONE) if wide else (SHARED, 1.0)
    if both == alone or estimate.probability is None:
        return estimate
    both, alone = both**strength, alone**strength
    probability: Scores = estimate.probability * (1.0 - (1.0 - alone) * q)
    probability[o] = estimate.probability[o] * (alone + (both - alone) * q)
    probability /= probability.sum()
    scores = probability[:-1].copy()
    target = None if estimate.target is None else best_of(scores)
    return estimate._replace(target=target, scores=scores, probability=probability)
