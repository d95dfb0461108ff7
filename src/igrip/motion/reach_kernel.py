"""One sample of reach detection, compiled; see :mod:`igrip.motion.reach_detection`."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.motion.kinematics import Kinematics, new_fit, new_kinematics, update_fit
from igrip.motion.noise import PRIOR_SAMPLES, new_noise, reset_noise, update_noise, variance_of
from igrip.motion.reach_state import ReachState

Array = NDArray[np.float64]

# layout of the state, used in this file alone
TIME, MOVING, ONSET, START, MAX_SPEED, MAX_SPEED_TIME, PATH, LAST = 0, 1, 2, 3, 6, 7, 8, 9
SLOW_SINCE, SLOW_VELOCITY, COUNT, RESTED, CANDIDATE, SWAY2, SIZE = 12, 13, 16, 17, 18, 19, 20
MAX_POINTS = 256
IMMEDIATE_ONSET_FACTOR = 2.0  # this many times beyond the onset distance one sample is enough
CANDIDATE_FRACTION = 0.5  # at this part of the onset distance a hand may have begun to move
RESTS, MAY_MOVE, MOVES = 0, 1, 2


class ReachParameters(NamedTuple):
    """The numbers of a :class:`igrip.motion.reach_detection.ReachConfig`, see there."""

    time_constant: float
    onset_distance: float
    onset_noise_factor: float
    initial_noise: float
    onset_sway_factor: float
    max_onset_sway: float
    rest_time_constant: float
    end_time_constant: float
    rest_speed: float
    rest_speed_fraction: float
    rest_noise_factor: float
    min_rest_duration: float
    max_gap: float


class ReachMemory(NamedTuple):
    """What is kept of one hand from sample to sample; the kernel changes it.

    Attributes
    ----------
    fit : (18,), now : Kinematics
        State and result of :func:`igrip.motion.kinematics.update_fit`.
    noise : (14,)
        State of :func:`igrip.motion.noise.update_noise`.
    state : (20,)
        Of the movement, as this file lays it out.
    points : (256, 4)
        Rows t, x, y, z since the onset [s, m].
    """

    fit: Array
    now: Kinematics
    noise: Array
    state: Array
    points: Array


def new_memory(parameters: ReachParameters) -> ReachMemory:
    """Return the memory before the first sample."""
    memory = ReachMemory(
        new_fit(), new_kinematics(), new_noise(0.0), np.zeros(SIZE), np.zeros((MAX_POINTS, 4))
    )
    _reset(memory, parameters)
    return memory


@kernel
def _reset(memory, parameters):
    variance = parameters.initial_noise * parameters.initial_noise
    memory.fit[:] = 0.0
    reset_noise(memory.noise, variance)
    memory.state[:] = 0.0
    memory.state[ONSET] = math.nan
    memory.state[SWAY2] = variance


@kernel
def _leaves_rest(memory, t, x, y, z, parameters):
    """Look at a hand that rests: it still does, may have begun to move, or moves from now on."""
    state, now = memory.state, memory.now
    if state[RESTED] == 0.0:
        state[START], state[START + 1], state[START + 2] = x, y, z
        state[ONSET] = t
    distance2 = away = 0.0
    for axis in range(3):
        offset = now.position[axis] - state[START + axis]
        distance2 += offset * offset
        away += offset * now.velocity[axis]
    noise = math.sqrt(variance_of(memory.noise))
    # sway and slow noise show around the place of rest; but a slow hand lags behind it, too
    sway = min(parameters.onset_sway_factor * math.sqrt(state[SWAY2]), parameters.max_onset_sway)
    threshold = max(parameters.onset_distance, parameters.onset_noise_factor * noise, sway)
    distance = math.sqrt(distance2)
    if distance > threshold and away > 0.0:
        if distance > IMMEDIATE_ONSET_FACTOR * threshold or state[CANDIDATE] > 0.0:
            return MOVES
        state[CANDIDATE] = 1.0
        return MAY_MOVE
    state[CANDIDATE] = 0.0
    near = distance < CANDIDATE_FRACTION * threshold
    if near:
        state[ONSET] = t
    state[RESTED] += 1.0
    passed, memory_s = t - state[TIME], parameters.rest_time_constant
    place = 1.0 - math.exp(-passed / memory_s)
    spread = 1.0 - math.exp(-passed / (2.0 * memory_s))
    place = max(place, 1.0 / state[RESTED])
    if near:  # a movement that begins is no sway
        spread = max(spread, 1.0 / (state[RESTED] + PRIOR_SAMPLES))
    state[SWAY2] += spread * (min(distance2, threshold * threshold) / 3.0 - state[SWAY2])
    for axis in range(3):
        newest = x if axis == 0 else y if axis == 1 else z
        state[START + axis] += place * (newest - state[START + axis])
    return RESTS if near else MAY_MOVE


@kernel
def _advance(memory, t, x, y, z, parameters):
    """Follow the movement to the newest fit."""
    state, now, points = memory.state, memory.now, memory.points
    weight = 1.0 - math.exp(-(t - state[TIME]) / parameters.end_time_constant)
    speed2 = slow2 = 0.0
    for axis in range(3):
        v = now.velocity[axis]
        state[SLOW_VELOCITY + axis] += weight * (v - state[SLOW_VELOCITY + axis])
        speed2 += v * v
        slow2 += state[SLOW_VELOCITY + axis] ** 2
    speed, slow_speed = math.sqrt(speed2), math.sqrt(slow2)
    moved = state[MOVING] == 1.0
    phase = MOVES if moved else _leaves_rest(memory, t, x, y, z, parameters)
    state[TIME] = t
    if phase == RESTS:
        state[COUNT] = 0.0
        return
    if state[COUNT] == 0.0:
        state[MAX_SPEED], state[PATH], state[LAST : LAST + 3] = 0.0, 0.0, state[START : START + 3]
    if phase == MOVES and not moved:
        state[MOVING], state[SLOW_SINCE] = 1.0, math.nan
    if speed > state[MAX_SPEED]:
        state[MAX_SPEED], state[MAX_SPEED_TIME] = speed, t
    rest_speed = max(
        parameters.rest_speed,
        parameters.rest_speed_fraction * state[MAX_SPEED],
        parameters.rest_noise_factor * math.sqrt(variance_of(memory.noise))
        / parameters.end_time_constant,
    )  # fmt: skip
    if phase == MOVES and slow_speed < rest_speed:
        if math.isnan(state[SLOW_SINCE]):
            state[SLOW_SINCE] = t
        if t - state[SLOW_SINCE] >= parameters.min_rest_duration:
            state[MOVING], state[CANDIDATE], state[ONSET] = 0.0, 0.0, t
            state[RESTED], state[COUNT] = 1.0, 0.0
            state[START : START + 3] = now.position
            return
    else:
        state[SLOW_SINCE] = math.nan
    step2 = 0.0
    for axis in range(3):
        step2 += (now.position[axis] - state[LAST + axis]) ** 2
        state[LAST + axis] = now.position[axis]
    state[PATH] += math.sqrt(step2)
    count = int(state[COUNT])
    if count == MAX_POINTS:  # a long movement: every second point will do
        for k in range(MAX_POINTS // 2):
            points[k] = points[2 * k]
        count = MAX_POINTS // 2
    points[count, 0] = t
    points[count, 1:] = now.position
    state[COUNT] = count + 1


@kernel
def update_reach(memory, t, x, y, z, parameters):
    """Add a sample; one call, since calls from Python cost more than what they do here.

    Parameters
    ----------
    memory : ReachMemory, changed
        Of the hand.
    t, x, y, z : float
        The sample [s, m]; ``t`` is later than the last.
    parameters : ReachParameters
        Of the detector.

    Returns
    -------
    ReachState
        Its arrays are copies.
    """
    state = memory.state
    if t - state[TIME] > parameters.max_gap:
        _reset(memory, parameters)
    if math.isnan(state[ONSET]):
        state[TIME] = t
    update_noise(memory.noise, t, x, y, z, parameters.rest_time_constant)
    update_fit(memory.fit, t, x, y, z, parameters.time_constant, memory.now)
    _advance(memory, t, x, y, z, parameters)
    return ReachState(
        state[MOVING] == 1.0,
        state[TIME],
        state[ONSET],
        state[START : START + 3].copy(),
        state[MAX_SPEED],
        state[MAX_SPEED_TIME],
        state[PATH],
        variance_of(memory.noise),
        memory.now.position.copy(),
        memory.now.velocity.copy(),
        memory.now.acceleration.copy(),
        memory.points[: int(state[COUNT])].copy(),
    )
