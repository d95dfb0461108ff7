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

from collections.abc import Callable, Collection, Mapping, Sequence
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
MIN_HINT = 0.01  # a pair is looked at where each hand alone believes at least so much; guess
MIN_BELIEF = 0.05  # hands contend for what each believes to be its target at least so much; guess
FULL_BELIEF = 0.15  # from here on the pair counts in full; between the two in part; guess
MAX_AGE = 0.1  # s; an older estimate of another hand does not count; guess

_half_extents: WeakKeyDictionary[ObjectModel, Scores] = WeakKeyDictionary()


def half_extents(model: ObjectModel) -> Scores:
    """Return half the edges of a model's box in its object frame, (3,) [m]."""
    known = _half_extents.get(model)
    if known is None:
        points = model.vertices @ model.mesh_from_object[:3, :3]
        known = _half_extents[model] = 0.5 * np.ptp(points, axis=0)
    return known


def is_wide(model: ObjectModel) -> bool:
    """Return whether an object exceeds the opening of a hand in every direction."""
    return bool(2.0 * min(half_extents(model).tolist()) > MAX_OPENING)


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
        self._within: dict[tuple[str, str], TargetsEstimator] = {}
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
        self._newest.update({h.id: h for h in hands if h.estimate.probability is not None})
        pairs = [
            (hand, other)
            for hand in hands if hand.motion.reach.moving and hand.id in self._newest
            for other in self._newest.values() if _may_contend(hand, other, wide)
        ]  # fmt: skip
        if not pairs:
            return estimates
        within: dict[tuple[str, str], TargetEstimate] = {}
        for pair in pairs:
            for hand, other in (pair, pair[::-1]):
                if (hand.id, other.id) not in within:
                    within[hand.id, other.id] = self._look_within(hand, other, wide)
        return [_join(hand, within, wide) for hand in hands]

    def _forget(self, followed: Collection[str], ids: list[str]) -> None:
        """Forget hands that are not followed, and everything where there are other objects."""
        if ids != self._ids:
            self._ids = ids
            self._newest.clear()
            self._within.clear()
        for gone in self._newest.keys() - set(followed):
            del self._newest[gone]
            self._within = {pair: one for pair, one in self._within.items() if gone not in pair}

    def _look_within(
        self, hand: HandEstimate, other: HandEstimate, wide: Sequence[int]
    ) -> TargetEstimate:
        """Estimate the target of a hand as part of a pair."""
        pair = hand.id, other.id
        if pair not in self._within:
            self._within[pair] = self._new_targets()
        return self._within[pair].update(hand.motion, _with_sides(hand, other, wide), {})


def _may_contend(hand: HandEstimate, other: HandEstimate, wide: Sequence[int]) -> bool:
    """Return whether a pair is worth a look: the other moves to, or is at, what both may take."""
    p, q = hand.estimate.probability, other.estimate.probability
    if p is None or q is None or other.id == hand.id or hand.motion.t - other.motion.t > MAX_AGE:
        return False
    moving = other.motion.reach.moving
    return any(min(p[o], q[o]) > MIN_HINT and (moving or q[o] > q[-1]) for o in wide)


def _join(
    hand: HandEstimate, within: Mapping[tuple[str, str], TargetEstimate], wide: Sequence[int]
) -> TargetEstimate:
    """Return the estimate of a hand, joined to that of another where the two contend."""
    best: tuple[float, int, Scores, Scores] | None = None
    for (id, other), estimate in within.items():
        if id != hand.id or not hand.motion.reach.moving:
            continue
        p, q = estimate.probability, within[other, id].probability
        if p is None or q is None:
            continue
        for o in wide:
            belief = float(min(p[o], q[o]))
            if belief > MIN_BELIEF and (best is None or belief > best[0]):
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
    sides = Cylinders(cylinders.rows.copy(), cylinders.paths)
    for o in wide:
        placed = geometry.objects[o]
        along = (placed.rotation @ placed.model.mesh_from_object[:3, :3]).T @ apart / distance
        half = half_extents(placed.model).tolist()
        edge = min(h / max(abs(part), 1e-9) for h, part in zip(half, along.tolist(), strict=True))
        sides.centre[o] += (edge - SIDE) / distance * apart
        sides.half_length[o] = sides.radius[o] = SIDE
        sides.velocity[o] = 0.0
    return geometry._replace(cylinders=lambda: sides)
