"""Targets of two hands together, where both may be taking one wide object.

Each hand has a posterior of its own (:mod:`igrip.targets`); their product says that the hands
choose independently. That is wrong beside a thing that is too wide for one hand: both take it, or
none. Two things follow.

A hand that takes a wide object together with another aims at its own side of it, not at its middle.
So the posterior of a hand within a pair is computed with the object replaced by its side: the place
where the line from the middle, in the direction from the other hand to this one, leaves the box.

The product of the posteriors p_A and p_B within the pair is multiplied by ``BOTH`` where both take
the wide object w, and by ``ALONE`` where one does. With ``q = p_B(w)``, the marginal of A is::

    p'_A(w) ∝ p_A(w) · (BOTH q + ALONE (1 - q))
    p'_A(j) ∝ p_A(j) · (ALONE q + (1 - q))

Hands that do not contend for a wide object are independent, and their estimates are left as they
are, to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from weakref import WeakKeyDictionary

import numpy as np

from igrip.geometry.cylinder import Cylinders
from igrip.geometry.scene import Geometry, PlacedObject
from igrip.grasps.opposition import MAX_OPENING
from igrip.objects.model import ObjectModel
from igrip.targets import HandEstimate, Scores, TargetEstimate, TargetsEstimator, best_of

BOTH = 4.0  # of simultaneous reaches beside a wide thing, three in ten are for it; guess
ALONE = 0.07  # one in thirty is of one hand alone; guess
SIDE = 0.04  # m; radius of the side that a hand aims at; guess: as of things in one hand
MIN_BELIEF = 0.05  # hands contend for what each believes to be its target at least so much; guess
FULL_BELIEF = 0.15  # from here on the pair counts in full; between the two in part; guess
MAX_AGE = 0.1  # s; an older estimate of another hand does not count; guess

_half_extents: WeakKeyDictionary[ObjectModel, Scores] = WeakKeyDictionary()


def half_extents(model: ObjectModel) -> Scores:
    """Return half the edges of a model's box in its object frame, (3,) [m]."""
    if model not in _half_extents:
        points = model.vertices @ model.mesh_from_object[:3, :3]
        _half_extents[model] = 0.5 * np.ptp(points, axis=0)
    return _half_extents[model]


def is_wide(model: ObjectModel) -> bool:
    """Return whether an object exceeds the opening of a hand in every direction."""
    return bool(2.0 * half_extents(model).min() > MAX_OPENING)


class JointTargets:
    """Joins the estimates of hands that contend for a wide object; leaves all others alone.

    Parameters
    ----------
    new_targets : function
        Makes a targets estimator.
    """

    def __init__(self, new_targets: Callable[[], TargetsEstimator]) -> None:
        self._new_targets = new_targets
        self._newest: dict[str, HandEstimate] = {}
        self._within: dict[tuple[str, str], tuple[TargetsEstimator, TargetEstimate]] = {}
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
            three hands and more, a hand is joined to the one that believes most in the same object.
        """
        estimates = [hand.estimate for hand in hands]
        wide = [o for o, one in enumerate(objects) if one.path is None and is_wide(one.model)]
        if len(followed) < 2 or not wide:
            self._newest.clear()
            self._within.clear()
            return estimates
        self._forget(followed, [placed.id for placed in objects])
        seen = [hand for hand in hands if hand.estimate.probability is not None]
        self._newest.update({hand.id: hand for hand in seen})
        for hand in seen:
            for other in self._others(hand):
                self._look_within(hand, other, wide)
        for a, hand in enumerate(hands):
            if hand.estimate.probability is not None and hand.motion.reach.moving:
                estimates[a] = self._join(hand, wide)
        return estimates

    def _forget(self, followed: Collection[str], ids: list[str]) -> None:
        """Forget hands that are not followed, and everything where there are other objects."""
        if ids != self._ids:
            self._ids = ids
            self._newest.clear()
            self._within.clear()
        for gone in self._newest.keys() - set(followed):
            del self._newest[gone]
            self._within = {pair: one for pair, one in self._within.items() if gone not in pair}

    def _others(self, hand: HandEstimate) -> list[HandEstimate]:
        return [
            other for other in self._newest.values()
            if other.id != hand.id and hand.motion.t - other.motion.t <= MAX_AGE
        ]  # fmt: skip

    def _look_within(self, hand: HandEstimate, other: HandEstimate, wide: Sequence[int]) -> None:
        """Estimate the target of a hand as part of a pair."""
        pair = hand.id, other.id
        known = self._within.get(pair)
        estimator = known[0] if known else self._new_targets()
        geometry = _with_sides(hand, other, wide)
        self._within[pair] = estimator, estimator.update(hand.motion, geometry, {})

    def _join(self, hand: HandEstimate, wide: Sequence[int]) -> TargetEstimate:
        """Return the estimate of a hand, joined to that of another where the two contend.

        They contend for what the other still moves to, or has arrived at.
        """
        best: tuple[float, int, Scores, Scores] | None = None
        for other in self._others(hand):
            own, theirs = self._within[hand.id, other.id], self._within.get((other.id, hand.id))
            p, q = own[1].probability, theirs[1].probability if theirs else None
            if p is None or q is None:
                continue
            for o in wide:
                belief = float(min(p[o], q[o]))
                meets = other.motion.reach.moving or q[o] > q[-1]
                if meets and belief > MIN_BELIEF and (best is None or belief > best[0]):
                    best = belief, o, p, q
        if best is None:
            return hand.estimate
        belief, o, p, q = best
        strength = min(1.0, (belief - MIN_BELIEF) / (FULL_BELIEF - MIN_BELIEF))
        return _mixed(hand.estimate, joint_marginal(p, float(q[o]), o), strength)


def joint_marginal(probability: Scores, q: float, o: int) -> Scores:
    """Return the probability of each target of one hand, given that of the other hand.

    Parameters
    ----------
    probability : (o + 1,)
        Of each object and, last, of none, as part of the pair but without the other hand.
    q : float
        Probability that the other hand takes the wide object.
    o : int
        Number of that object.
    """
    joint: Scores = probability * (ALONE * q + 1.0 - q)
    joint[o] = probability[o] * (BOTH * q + ALONE * (1.0 - q))
    joint /= joint.sum()
    return joint


def _mixed(estimate: TargetEstimate, joint: Scores, strength: float) -> TargetEstimate:
    """Return an estimate with so much of a joint posterior, from 0 to 1."""
    assert estimate.probability is not None
    probability: Scores = (1.0 - strength) * estimate.probability + strength * joint
    scores = probability[:-1].copy()
    return estimate._replace(target=best_of(scores), scores=scores, probability=probability)


def _with_sides(hand: HandEstimate, other: HandEstimate, wide: Sequence[int]) -> Geometry:
    """Return the geometry of a hand with each wide object replaced by its side."""
    geometry, cylinders = hand.geometry, hand.geometry.cylinders()
    apart = hand.motion.position - other.motion.position
    distance = float(np.linalg.norm(apart))
    if distance < SIDE:
        return geometry
    rows = cylinders.rows.copy()
    for o in wide:
        placed = geometry.objects[o]
        along = (placed.rotation @ placed.model.mesh_from_object[:3, :3]).T @ apart / distance
        edge = float((half_extents(placed.model) / np.maximum(np.abs(along), 1e-9)).min())
        side = cylinders.centre[o] + (edge - SIDE) * apart / distance
        rows[o] = Cylinders.of(
            side[None], cylinders.axis[o][None], np.array([SIDE]), np.array([SIDE]),
            np.zeros((1, 3)),
        ).rows[0]  # fmt: skip
    sides = Cylinders(rows, cylinders.paths)
    return geometry._replace(cylinders=lambda: sides)
