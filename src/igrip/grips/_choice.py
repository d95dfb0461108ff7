"""The choice among grasp candidates, compiled: what a movement says, and which it leads to."""

from __future__ import annotations

import math

import numpy as np

from igrip.compiled import kernel
from igrip.grips._placed_candidates import OPENING, place
from igrip.motion.reach_kernel import start_of, times_of
from igrip.taxonomy import NAMES

AHEAD = 0.25  # s; before the highest speed nobody knows how long a reach still lasts
# of velocity × time left is the rest of the way: 0.3 for a minimum jerk near its end, and both are
# estimated somewhat late
REMAINING = 0.25
MIN_LEFT, MAX_LEFT = 0.05, 0.5  # s
SHARE_OF_WAY = 0.4  # standard deviation of the way ahead, as a part of it
MIN_SPEED = 0.05  # m/s; slower hands have no heading
ROLL_STD = 0.1  # rad; of a candidate's own roll
COUNT = len(NAMES)


@kernel
def wrist_of(approach, closing, chord):
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
    h = np.zeros(3)  # to the left of the reach, across the approach
    h[0], h[1] = -chord[1], chord[0]
    along = h[0] * approach[0] + h[1] * approach[1]
    square = 0.0
    for k in range(3):
        h[k] -= along * approach[k]
        square += h[k] * h[k]
    if square < 1e-6:  # the hand comes from the side
        h[0], h[1] = -approach[2] * approach[0], -approach[2] * approach[1]
        h[2] = 1.0 - approach[2] * approach[2]
    level = across = 0.0
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        level += h[k] * closing[k]
        across += approach[k] * (h[i] * closing[j] - h[j] * closing[i])
    return _half_turn(math.atan2(across, level))


@kernel
def _half_turn(angle):
    """Return an angle that repeats after half a turn, between -π/2 and π/2."""
    return (angle + 0.5 * math.pi) % math.pi - 0.5 * math.pi


@kernel
def _foresee(state, now, decelerating, soon):
    """Write where the palm is expected at contact; return the standard deviation's moving part."""
    t, onset, peak = times_of(state)
    ahead = AHEAD
    if decelerating:
        ahead = REMAINING * min(max(2.0 * peak - onset - t, MIN_LEFT), MAX_LEFT)
    speed = math.sqrt(now[1, 0] ** 2 + now[1, 1] ** 2 + now[1, 2] ** 2)
    for k in range(3):
        soon[k] = now[0, k] + ahead * now[1, k]
    return speed, SHARE_OF_WAY * ahead * speed


@kernel
def choose(
    rows, grip, owner, rotations, translations, cylinders, objects, target, centre, state, now,
    decelerating, moving, across, ahead, palm_std, weights, grips,
):  # fmt: skip
    """Choose the likeliest candidate of the target.

    Parameters
    ----------
    rows, grip, owner
        Of :class:`igrip.grips._placed_candidates.PackedCandidates`.
    rotations, translations, cylinders
        As :func:`igrip.grips._placed_candidates.place`.
    objects : (>= o,)
        Probability of each object.
    target, centre : int, (3,)
        The target, and its centre of gravity [m].
    state, now, decelerating, moving
        Of :class:`igrip.motion.reach_kernel.ReachState`: of the measured samples, since the
        filtered ones lag by centimetres.
    across, ahead : 3 floats
        Of :class:`igrip.motion.palm_axes.PalmAxes`; zeros: unknown.
    palm_std, weights : float, 3 floats
        Of :class:`igrip.grips.GripConfig`.
    grips : (8,), written
        Probability of each grip, over all objects.

    Returns
    -------
    grip : int
        -1: the target has no candidates.
    opening, wrist, wrist_std : float
        [m, rad, rad]
    x, y, z : float
        The point of the grasp, world frame [m].
    """
    count = rows.shape[0]
    soon, heading, chord = np.empty(3), np.zeros(3), np.zeros(3)
    speed, moves = _foresee(state, now, decelerating, soon)
    start = start_of(state)
    for k in range(3):
        if speed > MIN_SPEED:
            heading[k] = now[1, k] / speed
        if k < 2:
            chord[k] = centre[k] - (start[k] if moving else now[0, k])
    level = math.hypot(chord[0], chord[1])
    if level > 1e-6:
        chord /= level
    score, free, vectors = np.empty(count), np.empty(count), np.empty((count, 4, 3))
    place(rows, owner, rotations, translations, cylinders, soon, math.hypot(palm_std, moves),
          heading, chord, across, ahead, weights, score, vectors, free)  # fmt: skip
    total, own = np.zeros(len(cylinders)), np.zeros(COUNT)
    highest = np.full(len(cylinders), -np.inf)
    for c in range(count):
        highest[owner[c]] = max(highest[owner[c]], score[c])
    for c in range(count):
        score[c] = math.exp(score[c] - highest[owner[c]])
        total[owner[c]] += score[c]
    known = 0.0
    for c in range(count):
        score[c] /= total[owner[c]]
        known += score[c] * objects[owner[c]]
        grips[grip[c]] += score[c] * objects[owner[c]]
        if owner[c] == target:
            own[grip[c]] += score[c]
    name = int(np.argmax(own))
    if not own[name] > 0.0:
        return -1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for g in range(COUNT):
        grips[g] /= max(known, 1e-300)
    best = -1
    for c in range(count):
        chosen = owner[c] == target and grip[c] == name
        if chosen and (best < 0 or score[c] > score[best]):
            best = c
    wrist = wrist_of(vectors[best, 1], vectors[best, 2], chord)
    # a roll that is free is even over its range; and others of this grip may be meant
    variance = ROLL_STD**2 + free[best] ** 2 / 3.0
    for c in range(count):
        if owner[c] == target and grip[c] == name:
            off = _half_turn(wrist_of(vectors[c, 1], vectors[c, 2], chord) - wrist)
            variance += score[c] / own[name] * off * off
    x, y, z = vectors[best, 3]
    return name, rows[best, OPENING], wrist, math.sqrt(variance), x, y, z
