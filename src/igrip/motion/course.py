"""The course of one movement so far: since when, from where, how fast, along which points."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.entities import Vector
from igrip.motion import kinematics
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]
# state
TIME, MOVING, ONSET, START, PEAK, PEAK_AT, PATH, LAST = 0, 1, 2, 3, 6, 7, 8, 9
SLOW_SINCE, CALM, COUNT, STATE = 12, 13, 16, 17
MOST_POINTS = 256


class CourseConfig(Settings):
    """When a movement begins and ends, and how it is smoothed."""

    time_constant: float = quantity(
        0.06, "s", "memory of the fit for position, velocity, acceleration",
        "guess; 0.04-0.15 were tried on near/far reaches, by a script that is not kept", gt=0,
    )  # fmt: skip
    calm: float = quantity(
        0.08, "s", "memory of the velocity by which rest is told from movement", "guess", gt=0
    )
    onset_speed: float = quantity(0.10, "m/s", "above it a movement has begun", "as reach", gt=0)
    rest_speed: float = quantity(0.05, "m/s", "below it a hand rests", "as reach", gt=0)
    rest_fraction: float = quantity(
        0.10, "1", "below this part of the peak it rests", "SPEC §7", ge=0, lt=1
    )
    dwell: float = quantity(0.10, "s", "rest must last this long", "as reach", ge=0)
    longest_gap: float = quantity(
        0.5, "s", "after it nothing is known of the movement before", "guess", gt=0
    )


@kernel
def advance(state, points, fit, now, parameters):
    """Take the next fit; see :class:`Course`.

    Parameters
    ----------
    state : (17,), points : (256, 4), changed
        Of :class:`Course`.
    fit : (18,), now : (9,)
        State and result of :mod:`igrip.motion.kinematics`.
    parameters : (5,)
        Calm, onset speed, rest speed, rest fraction, dwell.
    """
    t = fit[kinematics.TIME]
    calm, onset_speed, rest_speed, fraction, dwell = parameters
    weight = 1.0 - math.exp(-(t - state[TIME]) / calm)
    fast2 = slow2 = 0.0
    for axis in range(3):
        v = now[kinematics.VELOCITY + axis]
        state[CALM + axis] += weight * (v - state[CALM + axis])
        fast2 += v * v
        slow2 += state[CALM + axis] ** 2
    fast, slow = math.sqrt(fast2), math.sqrt(slow2)
    state[TIME] = t
    if state[MOVING] == 0.0:
        if math.isnan(state[ONSET]) or slow < rest_speed:
            state[ONSET] = t
            state[START : START + 3] = now[:3]
        if slow <= onset_speed and fast <= 2.5 * onset_speed:
            return
        state[MOVING], state[PEAK], state[SLOW_SINCE], state[COUNT] = 1.0, 0.0, math.nan, 0.0
        state[PATH], state[LAST : LAST + 3] = 0.0, state[START : START + 3]
    if fast > state[PEAK]:
        state[PEAK], state[PEAK_AT] = fast, t
    if slow < max(rest_speed, fraction * state[PEAK]):
        if math.isnan(state[SLOW_SINCE]):
            state[SLOW_SINCE] = t
        if t - state[SLOW_SINCE] >= dwell:
            state[MOVING], state[ONSET] = 0.0, t
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
    if count == MOST_POINTS:  # a long movement: every second point will do
        for k in range(MOST_POINTS // 2):
            points[k] = points[2 * k]
        count = MOST_POINTS // 2
    points[count, 0] = t
    points[count, 1:] = now[:3]
    state[COUNT] = count + 1


@kernel
def take(fit, now, state, points, t, x, y, z, time_constant, parameters):
    """Take a sample: fit, then advance; one call, as calls cost more than what they do here."""
    kinematics.step(fit, t, x, y, z, time_constant, now)
    advance(state, points, fit, now, parameters)


class Movement(NamedTuple):
    """What a course holds at one sample.

    Attributes
    ----------
    moving : bool
        Whether the hand moves.
    state : (17,)
        As the indices of this module name it.
    points : (n, 4)
        Rows t, x, y, z since the onset [s, m].
    now : (9,)
        Position, velocity, acceleration [m, m/s, m/s²].
    """

    moving: bool
    state: Array
    points: Array
    now: Array

    @property
    def start(self) -> Array:
        """Where it began, shape (3,) [m]."""
        return self.state[START : START + 3]

    @property
    def elapsed(self) -> float:
        """Time since the onset [s]."""
        return float(self.state[TIME] - self.state[ONSET])


class Course:
    """Follows one hand from rest through a movement to rest again, at any rate of samples."""

    def __init__(self, config: CourseConfig | None = None) -> None:
        self._config = config = config or CourseConfig()
        self._parameters = np.array(
            [config.calm, config.onset_speed, config.rest_speed, config.rest_fraction, config.dwell]
        )
        self._fit = np.zeros(kinematics.STATE)
        self._now = np.zeros(kinematics.RESULT)
        self._state = np.zeros(STATE)
        self._points = np.zeros((MOST_POINTS, 4))
        self._begin()

    def _begin(self) -> None:
        self._fit[:] = 0.0
        self._state[:] = 0.0
        self._state[ONSET] = math.nan

    def update(self, t: float, position: Array | Vector) -> Movement:
        """Take a sample at ``t`` [s], later than the last; return the movement so far."""
        if t - self._state[TIME] > self._config.longest_gap:
            self._begin()
        if math.isnan(self._state[ONSET]):
            self._state[TIME] = t
        x, y, z = position
        take(
            self._fit, self._now, self._state, self._points, t, x, y, z,
            self._config.time_constant, self._parameters,
        )  # fmt: skip
        moving = bool(self._state[MOVING])
        count = int(self._state[COUNT]) if moving else 0
        return Movement(moving, self._state.copy(), self._points[:count].copy(), self._now.copy())
