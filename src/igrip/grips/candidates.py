"""The grasp candidate of the target that the movement leads to, with opening and wrist.

Every object has a few ways to be grasped, found in its mesh or declared (:mod:`igrip.grasps`). The
posterior over targets is carried over to them: given a target, each of its candidates is weighed by
its prior, by how near the palm is expected to where that candidate has it, by the direction of the
movement, and by how the hand is turned where its source measures that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import Geometry, PlacedObject
from igrip.grasps.candidates import candidates_of
from igrip.grips import GRIPS, Grasp, Grip, GripConfig
from igrip.grips._placed_candidates import (
    HandEvidence,
    PackedCandidates,
    PlacedCandidates,
    pack_candidates,
    place,
)
from igrip.motion.reach_kernel import times_of
from igrip.motion.trajectory import Motion
from igrip.targets import TargetEstimate
from igrip.taxonomy import NAMES

Array = NDArray[np.float64]

MIN_TARGET = 0.01  # objects less likely than this have no say
AHEAD = 0.25  # s; before the highest speed nobody knows how long a reach still lasts
# of velocity × time left is the rest of the way: 0.3 for a minimum jerk near its end, and both are
# estimated somewhat late
REMAINING = 0.25
SHARE_OF_WAY = 0.4  # standard deviation of the way ahead, as a part of it
MIN_SPEED = 0.05  # m/s; slower hands have no heading
ROLL_STD = 0.1  # rad; of a candidate's own roll
ZERO = np.zeros(3)


@GRIPS.register("candidates")
class CandidateGrip:
    """Selects the likeliest grasp candidate of the target.

    Parameters
    ----------
    config : GripConfig
        Weights of the evidence.
    """

    def __init__(self, config: GripConfig) -> None:
        self._config = config
        self._weights = (config.heading_weight, config.pointing_weight, config.turn_weight)
        self._packed: tuple[tuple[int, ...], PackedCandidates] | None = None

    def select(self, estimate: TargetEstimate, geometry: Geometry, motion: Motion) -> Grip:
        """Return grip, probability of each grip, opening and wrist; none without a target.

        The grip, opening and wrist are those of the target; the probability of grips is averaged
        over the objects that are likely.
        """
        target = estimate.target
        if target is None:
            return Grip(None)
        packed = self._candidates(geometry.objects)
        if not (packed.owner == target).any():
            return Grip(None)
        evidence = _evidence(motion, geometry.objects[target], self._config.palm_std)
        placed = place(
            packed, evidence, np.array([o.rotation for o in geometry.objects]),
            np.array([o.translation for o in geometry.objects]), geometry.cylinders().rows,
            self._weights,
        )  # fmt: skip
        objects = np.zeros(len(geometry.objects))
        objects[target] = 1.0
        if estimate.probability is not None:
            objects = np.asarray(estimate.probability)[:-1]
            objects = np.where(objects >= min(MIN_TARGET, objects[target]), objects, 0.0)
        share = _share(placed.score, packed.owner, objects)
        grips = np.bincount(packed.grip, share, len(NAMES))
        own = packed.owner == target
        of_target = np.bincount(packed.grip[own], share[own], len(NAMES))
        name = int(np.argmax(of_target))
        chosen = np.flatnonzero(own & (packed.grip == name))
        probability = {NAMES[g]: float(grips[g]) for g in np.unique(packed.grip)}
        return Grip(NAMES[name], probability, _grasp(packed, placed, share, chosen, evidence))

    def _candidates(self, objects: Sequence[PlacedObject]) -> PackedCandidates:
        """Return the candidates of these objects; packed anew when others come."""
        key = tuple(id(o.model) for o in objects)
        if self._packed is None or self._packed[0] != key:
            self._packed = key, pack_candidates([candidates_of(o.model) for o in objects])
        return self._packed[1]


def _evidence(motion: Motion, target: PlacedObject, palm_std: float) -> HandEvidence:
    """Return what a movement says; see the module."""
    # of the measured samples: the filtered ones lag by centimetres
    position, velocity = motion.reach.now[0], motion.reach.now[1]
    speed, ahead = math.hypot(*velocity.tolist()), AHEAD
    if motion.reach.phase == "decelerating":
        now, onset, peak = times_of(motion.reach.state)
        ahead = REMAINING * min(max(2.0 * peak - onset - now, 0.05), 0.5)
    way = ahead * velocity
    spread = math.hypot(palm_std, SHARE_OF_WAY * ahead * speed)
    start = motion.reach.start if motion.reach.moving else position
    chord = target.centre - start
    level = math.hypot(chord[0], chord[1])
    chord = np.array([chord[0] / level, chord[1] / level, 0.0]) if level > 1e-6 else ZERO
    palm = motion.palm
    return HandEvidence(
        position + way, spread, velocity / speed if speed > MIN_SPEED else ZERO, chord,
        ZERO if palm is None else np.array(palm.across),
        ZERO if palm is None else np.array(palm.ahead),
    )  # fmt: skip


def _share(score: Array, owner: NDArray[np.int64], objects: Array) -> Array:
    """Return the probability of each candidate: that of its object, times its own there."""
    best = np.full(len(objects), -np.inf)
    np.maximum.at(best, owner, score)
    odds = np.exp(score - best[owner])
    total = np.bincount(owner, odds, len(objects))
    share = odds / total[owner] * objects[owner]
    whole: Array = share / share.sum()
    return whole


def _grasp(
    packed: PackedCandidates, placed: PlacedCandidates, share: Array, chosen: NDArray[np.int64],
    evidence: HandEvidence,
) -> Grasp:  # fmt: skip
    """Return the likeliest of some candidates; its wrist is as sure as the others agree with it."""
    best = int(chosen[np.argmax(share[chosen])])
    angles = np.array([wrist_of(placed.approach[c], placed.closing[c], evidence.chord)
                       for c in chosen])  # fmt: skip
    wrist = wrist_of(placed.approach[best], placed.closing[best], evidence.chord)
    off = (angles - wrist + 0.5 * math.pi) % math.pi - 0.5 * math.pi
    weight = share[chosen] / share[chosen].sum()
    # a roll that is free is even over its range
    own2 = ROLL_STD**2 + placed.free[best] ** 2 / 3.0
    return Grasp(
        tuple(placed.point[best].tolist()), float(packed.opening[best]), wrist,
        math.sqrt(own2 + float(weight @ off**2)),
    )  # fmt: skip


def wrist_of(approach: Array, closing: Array, chord: Array) -> float:
    """Return the rotation of a hand about its approach, between -π/2 and π/2 [rad].

    Parameters
    ----------
    approach, closing : (3,)
        Unit vectors: of the palm's way, and from the thumb to the fingers (or back).
    chord : (3,)
        Level unit vector of the reach.

    Returns
    -------
    float
        0 where the closing direction lies level and across the reach.
    """
    ax, ay, az = approach.tolist()
    cx, cy, cz = closing.tolist()
    lx, ly = -float(chord[1]), float(chord[0])  # to the left of the reach
    along = lx * ax + ly * ay
    hx, hy, hz = lx - along * ax, ly - along * ay, -along * az
    if hx * hx + hy * hy + hz * hz < 1e-6:  # the hand comes from the side
        hx, hy, hz = -az * ax, -az * ay, 1.0 - az * az
    across = ax * (hy * cz - hz * cy) + ay * (hz * cx - hx * cz) + az * (hx * cy - hy * cx)
    angle = math.atan2(across, hx * cx + hy * cy + hz * cz)
    return (angle + 0.5 * math.pi) % math.pi - 0.5 * math.pi
