"""One sample of reach detection, compiled, and its result.

See :mod:`igrip.motion.reach_detection` for the method.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.motion.kinematics import new_fit, update_fit
from igrip.motion.noise import PRIOR_SAMPLES, new_noise, reset_noise, update_noise, variance_of

Array = NDArray[np.float64]
Phase = Literal["rest", "accelerating", "decelerating"]

# layout of the state, used in this file alone
TIME, MOVING, ONSET, START, MAX_SPEED, MAX_SPEED_TIME, PATH, LAST = 0, 1, 2, 3, 6, 7, 8, 9
SLOW_SINCE, SLOW_VELOCITY, COUNT, RESTED, CANDIDATE, SWAY2 = 12, 13, 16, 17, 18, 19
NOISE2, SIZE = 20, 21
MAX_POINTS = 256
IMMEDIATE_ONSET_FACTOR = 2.0  # this many times beyond the onset distance one sample is enough
CANDIDATE_FRACTION = 0.5  # at this part of the onset distance a hand may have begun to move
RESTS, MAY_MOVE, MOVES = 0, 1, 2


class ReachParameters(NamedTuple):
    """The numbers of a :class:`igrip.motion.reach_detection.ReachConfig`."""

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
    fit, now : (18,), (3, 3)
        State and result of :func:`igrip.motion.kinematics.update_fit`.
    noise : (14,)
        State of :func:`igrip.motion.noise.update_noise`.
    state : (21,)
        Of the movement, as this file lays it out.
    points : (256, 4)
        Rows t, x, y, z since the onset [s, m].
    """

    fit: Array
    now: Array
    noise: Array
    state: Array
    points: Array

    @classmethod
    def new(cls, parameters: ReachParameters) -> ReachMemory:
        """Return the memory before the first sample."""
        points = np.zeros((MAX_POINTS, 4))
        memory = cls(*new_fit(), new_noise(0.0), np.zeros(SIZE), points)
        _reset(memory, parameters)
        return memory


class ReachState(NamedTuple):
    """Where a hand is in its movement, at one sample. World frame.

    Attributes
    ----------
    moving : bool
        Whether the hand moves.
    state : (21,)
        As this file lays it out, read by the properties, and in kernels by :func:`start_of` etc.
    points : (n, 4)
        Rows t, x, y, z since the onset [s, m]; not empty for a resting hand that may have begun to
        move.
    now : (3, 3)
        Rows position, velocity and acceleration, fitted [m, m/s, m/s²].
    """

    moving: bool
    state: Array
    points: Array
    now: Array

    @classmethod
    def of(cls, memory: ReachMemory) -> ReachState:
        """Return a copy of what is known after the newest sample."""
        state = memory.state.copy()
        points = memory.points[: int(state[COUNT])].copy()
        return cls(bool(state[MOVING]), state, points, memory.now.copy())

    @property
    def may_move(self) -> bool:
        """Whether the hand moves or may have begun to."""
        return len(self.points) > 0

    @property
    def phase(self) -> Phase:
        """``rest``, ``accelerating`` (this sample is the fastest so far) or ``decelerating``."""
        if not self.moving:
            return "rest"
        return "accelerating" if self.state[MAX_SPEED_TIME] == self.state[TIME] else "decelerating"

    @property
    def onset(self) -> float:
        """When the hand last was near its place of rest [s]."""
        return float(self.state[ONSET])

    @property
    def start(self) -> Array:
        """Where it rested, shape (3,) [m]."""
        return self.state[START : START + 3]

    @property
    def elapsed(self) -> float:
        """Time since the onset [s]; 0 at rest."""
        return float(self.state[TIME] - self.state[ONSET]) if self.moving else 0.0

    @property
    def peak_speed(self) -> float:
        """Highest speed since the onset [m/s]; 0 at rest."""
        return float(self.state[MAX_SPEED]) if self.moving else 0.0

    @property
    def path_length(self) -> float:
        """Length of the path since the onset [m]; 0 at rest."""
        return float(self.state[PATH]) if self.moving else 0.0


@kernel
def times_of(state):
    """Return the times of the sample, of the onset and of the highest speed since [s]."""
    return state[TIME], state[ONSET], state[MAX_SPEED_TIME]


@kernel
def set_reach(state, max_speed, max_speed_time, path_length):
    """Set the highest speed, when it was, and the length of the path [m/s, s, m]."""
    state[MAX_SPEED], state[MAX_SPEED_TIME], state[PATH] = max_speed, max_speed_time, path_length


@kernel
def start_of(state):
    """Return where the hand rested, shape (3,) [m]; a view."""
    return state[START : START + 3]


@kernel
def extent_of(state):
    """Return the highest speed and the length of the path since the onset [m/s, m]."""
    return state[MAX_SPEED], state[PATH]


@kernel
def noise_variance_of(state):
    """Return the estimated variance of the samples, each axis [m²]."""
    return state[NOISE2]


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
    state, position, velocity = memory.state, memory.now[0], memory.now[1]
    if state[RESTED] == 0.0:
        state[START], state[START + 1], state[START + 2] = x, y, z
        state[ONSET] = t
    distance2 = away = 0.0
    for axis in range(3):
        offset = position[axis] - state[START + axis]
        distance2 += offset * offset
        away += offset * velocity[axis]
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
    state, points = memory.state, memory.points
    position, velocity = memory.now[0], memory.now[1]
    weight = 1.0 - math.exp(-(t - state[TIME]) / parameters.end_time_constant)
    speed2 = slow2 = 0.0
    for axis in range(3):
        v = velocity[axis]
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
            state[START : START + 3] = position
            return
    else:
        state[SLOW_SINCE] = math.nan
    step2 = 0.0
    for axis in range(3):
        step2 += (position[axis] - state[LAST + axis]) ** 2
        state[LAST + axis] = position[axis]
    state[PATH] += math.sqrt(step2)
    count = int(state[COUNT])
    if count == MAX_POINTS:  # a long movement: every second point will do
        for k in range(MAX_POINTS // 2):
            points[k] = points[2 * k]
        count = MAX_POINTS // 2
    points[count, 0] = t
    points[count, 1:] = position
    state[COUNT] = count + 1


@kernel
def update_reach(fit, now, noise, state, points, t, x, y, z, parameters):
    """Add a sample. One call: calls from Python cost more than what they do here.

    Parameters
    ----------
    fit, now, noise, state, points : arrays, changed
        The fields of the hand's :class:`ReachMemory`: numba reads arrays faster than named tuples.
    t, x, y, z : float
        The sample [s, m]; ``t`` is later than the last.
    parameters : (13,)
        The fields of :class:`ReachParameters`.
    """
    memory = ReachMemory(fit, now, noise, state, points)
    p = parameters
    named = ReachParameters(
        p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12]
    )
    if t - state[TIME] > named.max_gap:
        _reset(memory, named)
    if math.isnan(state[ONSET]):
        state[TIME] = t
    update_noise(noise, t, x, y, z, named.rest_time_constant)
    update_fit(fit, t, x, y, z, named.time_constant, now)
    _advance(memory, t, x, y, z, named)
    state[NOISE2] = variance_of(noise)
