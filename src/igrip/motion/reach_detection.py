"""Is this hand moving, since when, from where, how fast, along which points: decided causally.

A hand moves once it has left the place where it rested by more than the noise of its measurements
explains; a speed alone would take noise at a low rate for movement, and a slow hand for a resting
one. The noise is learned all the while, its sway while the hand rests.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.entities import Vector
from igrip.motion import kinematics, noise
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]
Phase = Literal["rest", "accelerating", "decelerating"]
# state
TIME, MOVING, ONSET, START, PEAK, PEAK_AT, PATH, LAST = 0, 1, 2, 3, 6, 7, 8, 9
SLOW_SINCE, CALM, COUNT, RESTED, AWAY, SPREAD, NOISE = 12, 13, 16, 17, 18, 19, 20
STATE = NOISE + noise.STATE
MAX_POINTS = 256
SURE = 2.0  # so many times beyond what begins a movement, one sample is enough
STIRS = 0.5  # at so much of it, a hand may have begun to move


class ReachConfig(Settings):
    """When a movement begins and ends, and how it is smoothed."""

    time_constant: float = quantity(
        0.06, "s", "memory of the fit for position, velocity, acceleration",
        "guess; 0.04-0.15 were tried on near/far reaches, by a script that is not kept", gt=0,
    )  # fmt: skip
    leave: float = quantity(
        0.008,
        "m",
        "so far from its place of rest a hand moves",
        "guess: twice a resting sway",
        gt=0,
    )
    leave_noise: float = quantity(
        4.0, "1", "and at least so many standard deviations of a measurement", "guess", ge=0
    )
    noise: float = quantity(
        0.003, "m", "standard deviation of a measurement, each axis, before any is known",
        "guess: hand trackers, 1-5 mm", gt=0,
    )  # fmt: skip
    leave_sway: float = quantity(
        5.0, "1", "and at least so many of what it and its measurements sway at rest, which is "
        "alike for many samples", "guess; 4 took 20 % of a rest at 60 Hz for movement", ge=0,
    )  # fmt: skip
    max_sway: float = quantity(
        0.03, "m", "no further does sway and slow noise put it off", "guess", ge=0
    )
    rest_memory: float = quantity(1.0, "s", "memory of the place of rest, of noise", "guess", gt=0)
    calm: float = quantity(
        0.10, "s", "memory of the velocity by which the end is told", "guess", gt=0
    )
    rest_speed: float = quantity(0.04, "m/s", "below it a hand rests", "guess", gt=0)
    rest_fraction: float = quantity(
        0.10, "1", "below this part of the peak speed it rests", "SPEC §7", ge=0, lt=1
    )
    rest_noise: float = quantity(
        1.5, "1", "as do so many deviations of a measurement in the memory of the velocity",
        "guess", ge=0,
    )  # fmt: skip
    dwell: float = quantity(0.10, "s", "rest must last this long to end a movement", "guess", ge=0)
    max_gap: float = quantity(
        0.5,
        "s",
        "after it nothing is known of the movement before (the gate of a hand, "
        "GatingConfig.hand_limit, starts it anew earlier)",
        "guess",
        gt=0,
    )


@kernel
def _leaves(state, fit, now, parameters):
    """Look at a hand that rests; return 0 if it still does, 1 if it stirs, 2 if it moves now."""
    leave, leave_noise, leave_sway, max_sway, memory = parameters[0:5]
    t = fit[kinematics.TIME]
    if state[RESTED] == 0.0:
        state[START : START + 3] = fit[kinematics.NEWEST : kinematics.NEWEST + 3]
        state[ONSET] = t
    far2 = towards = 0.0
    for axis in range(3):
        away = now[axis] - state[START + axis]
        far2 += away * away
        towards += away * now[kinematics.VELOCITY + axis]
    white = math.sqrt(state[NOISE + noise.VARIANCE])
    # sway and slow noise are seen around the place of rest; but a slow hand lags behind it, too
    sway = min(leave_sway * math.sqrt(state[SPREAD]), max_sway)
    least = max(leave, leave_noise * white, sway)
    far = math.sqrt(far2)
    if far > least and towards > 0.0:
        if far > SURE * least or state[AWAY] > 0.0:
            return 2
        state[AWAY] = 1.0
        return 1
    state[AWAY] = 0.0
    stirs = far >= STIRS * least
    if not stirs:
        state[ONSET] = t
    state[RESTED] += 1.0
    passed = t - state[TIME]
    place, spread = 1.0 - math.exp(-passed / memory), 1.0 - math.exp(-passed / (2.0 * memory))
    place = max(place, 1.0 / state[RESTED])
    if not stirs:  # a movement that begins is no sway
        spread = max(spread, 1.0 / (state[RESTED] + noise.WORTH))
    state[SPREAD] += spread * (min(far2, least * least) / 3.0 - state[SPREAD])
    for axis in range(3):
        newest = fit[kinematics.NEWEST + axis]
        state[START + axis] += place * (newest - state[START + axis])
    return 1 if stirs else 0


@kernel
def advance(state, points, fit, now, parameters):
    """Take the next fit; see :class:`ReachDetector`.

    Parameters
    ----------
    state : (34,), points : (256, 4), changed
        Of :class:`ReachDetector`.
    fit : (18,), now : (9,)
        State and result of :mod:`igrip.motion.kinematics`.
    parameters : (10,)
        Leave, leave noise, leave sway, most sway, rest memory, calm, rest speed, rest fraction,
        rest noise, dwell.
    """
    t = fit[kinematics.TIME]
    calm, rest_speed, fraction, rest_noise, dwell = parameters[5:10]
    weight = 1.0 - math.exp(-(t - state[TIME]) / calm)
    fast2 = slow2 = 0.0
    for axis in range(3):
        v = now[kinematics.VELOCITY + axis]
        state[CALM + axis] += weight * (v - state[CALM + axis])
        fast2 += v * v
        slow2 += state[CALM + axis] ** 2
    fast, slow = math.sqrt(fast2), math.sqrt(slow2)
    moved = state[MOVING] == 1.0
    leaves = 2 if moved else _leaves(state, fit, now, parameters)
    state[TIME] = t
    if leaves == 0:
        state[COUNT] = 0.0
        return
    if state[COUNT] == 0.0:
        state[PEAK], state[PATH], state[LAST : LAST + 3] = 0.0, 0.0, state[START : START + 3]
    if leaves == 2 and not moved:
        state[MOVING], state[SLOW_SINCE] = 1.0, math.nan
    if fast > state[PEAK]:
        state[PEAK], state[PEAK_AT] = fast, t
    still = max(
        rest_speed,
        fraction * state[PEAK],
        rest_noise * math.sqrt(state[NOISE + noise.VARIANCE]) / calm,
    )
    if leaves == 2 and slow < still:
        if math.isnan(state[SLOW_SINCE]):
            state[SLOW_SINCE] = t
        if t - state[SLOW_SINCE] >= dwell:
            state[MOVING], state[AWAY], state[ONSET] = 0.0, 0.0, t
            state[RESTED], state[COUNT] = 1.0, 0.0
            state[START : START + 3] = now[:3]
            return
    else:
        state[SLOW_SINCE] = math.nan
    way2 = 0.0
    for axis in range(3):
        way2 += (now[axis] - state[LAST + axis]) ** 2
        state[LAST + axis] = now[axis]
    state[PATH] += math.sqrt(way2)
    count = int(state[COUNT])
    if count == MAX_POINTS:  # a long movement: every second point will do
        for k in range(MAX_POINTS // 2):
            points[k] = points[2 * k]
        count = MAX_POINTS // 2
    points[count, 0] = t
    points[count, 1:] = now[:3]
    state[COUNT] = count + 1


@kernel
def take(fit, now, state, points, t, x, y, z, time_constant, parameters):
    """Take a sample: fit, then advance; one call, as calls cost more than what they do here."""
    noise.watch(state[NOISE:], t, x, y, z, parameters[4])
    kinematics.step(fit, t, x, y, z, time_constant, now)
    advance(state, points, fit, now, parameters)


class ReachState(NamedTuple):
    """Where a hand is in its movement, at one sample.

    Attributes
    ----------
    moving : bool
        Whether the hand moves.
    state : (34,)
        As the indices of this module name it.
    points : (n, 4)
        Rows t, x, y, z since the onset [s, m]; of a resting hand that may have begun to move, too.
    now : (9,)
        Position, velocity, acceleration [m, m/s, m/s²].
    """

    moving: bool
    state: Array
    points: Array
    now: Array

    @property
    def stirs(self) -> bool:
        """Whether it moves, or may have begun to: whether there is something to look at."""
        return len(self.points) > 0

    @property
    def phase(self) -> Phase:
        """``rest``, ``accelerating`` (this sample is the fastest so far) or ``decelerating``."""
        if not self.moving:
            return "rest"
        return "accelerating" if self.state[PEAK_AT] == self.state[TIME] else "decelerating"

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
        return float(self.state[PEAK]) if self.moving else 0.0


class ReachDetector:
    """Follows one hand from rest through a movement to rest again, at any rate of samples."""

    def __init__(self, config: ReachConfig | None = None) -> None:
        self._config = config = config or ReachConfig()
        self._parameters = np.array([
            config.leave, config.leave_noise, config.leave_sway, config.max_sway,
            config.rest_memory, config.calm, config.rest_speed, config.rest_fraction,
            config.rest_noise, config.dwell,
        ])  # fmt: skip
        self._fit = np.zeros(kinematics.STATE)
        self._now = np.zeros(kinematics.RESULT)
        self._state = np.zeros(STATE)
        self._points = np.zeros((MAX_POINTS, 4))
        self._begin()

    def _begin(self) -> None:
        self._fit[:] = 0.0
        self._state[:] = 0.0
        self._state[ONSET] = math.nan
        self._state[NOISE + noise.VARIANCE] = self._state[SPREAD] = self._config.noise**2

    def update(self, t: float, position: Array | Vector) -> ReachState:
        """Take a sample at ``t`` [s], later than the last; return the movement so far."""
        if t - self._state[TIME] > self._config.max_gap:
            self._begin()
        if math.isnan(self._state[ONSET]):
            self._state[TIME] = t
        x, y, z = position
        take(
            self._fit, self._now, self._state, self._points, t, x, y, z,
            self._config.time_constant, self._parameters,
        )  # fmt: skip
        moving = bool(self._state[MOVING])
        count = int(self._state[COUNT])
        return ReachState(moving, self._state.copy(), self._points[:count].copy(), self._now.copy())
