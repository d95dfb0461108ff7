"""Recent trajectory of one hand, and its near future by weighted quadratic regression."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Vector
from igrip.motion.filters import OneEuroConfig, PositionFilter
from igrip.motion.palm_axes import PalmAxes
from igrip.motion.quadratic_fit import predict
from igrip.motion.reach_detection import ReachConfig, ReachDetector
from igrip.motion.reach_kernel import ReachState
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]


class MotionConfig(Settings):
    """Window, regression and prediction of a hand's motion."""

    filter: OneEuroConfig = OneEuroConfig()
    reach: ReachConfig = ReachConfig()
    window: int = quantity(
        20, "samples", "n_f, length of the window", "guess; paper: n_f", ge=3, le=1000
    )
    window_duration: float = quantity(1.0, "s", "older samples leave the window", "guess", gt=0)
    future_points: int = quantity(10, "1", "number of predicted points", "guess", ge=1, le=100)
    horizon: float = quantity(0.3, "s", "time of the last predicted point", "guess", gt=0)


class Motion(NamedTuple):
    """The motion of one hand at its newest sample. World frame.

    Attributes
    ----------
    t : float
        Time of the newest sample [s].
    position : (3,)
        Its filtered position [m].
    coefficients : (3, 3)
        Rows c0, c1, c2 of ``p(s) = c0 + c1 s + c2 s²``, s the time from ``t`` on.
    velocity : (3,)
        Of the polynomial at ``t`` [m/s].
    speed : float
        Its norm [m/s].
    window_peak_speed : float or None
        v_max_win: the highest speed over the window *before* this sample; None without one.
    future : (m, 3)
        Predicted positions [m].
    future_velocity : (m, 3)
        Predicted velocities [m/s].
    reach : ReachState
        Phase and course of the movement so far, from the measured samples.
    palm : PalmAxes or None
        How the hand is turned, where its source measures that.
    """

    t: float
    position: Array
    coefficients: Array
    velocity: Array
    speed: float
    window_peak_speed: float | None
    future: Array
    future_velocity: Array
    reach: ReachState
    palm: PalmAxes | None = None


class Trajectory:
    """Filter, sliding window and regression of one hand.

    Parameters
    ----------
    config : MotionConfig
        Its parameters.
    """

    def __init__(self, config: MotionConfig) -> None:
        self._config = config
        steps = np.arange(1, config.future_points + 1) * (config.horizon / config.future_points)
        self._steps = steps
        self.reset()

    def reset(self) -> None:
        """Forget everything, as before the first sample."""
        self._filter = PositionFilter(self._config.filter)
        self._reach = ReachDetector(self._config.reach)
        # twice the window, so that it can slide without moving on every sample
        self._times = np.empty(2 * self._config.window)
        self._positions = np.empty((2 * self._config.window, 3))
        self._speeds = np.empty(2 * self._config.window)
        self._first = self._end = 0

    def __len__(self) -> int:
        return self._end - self._first

    @property
    def past(self) -> Array:
        """The filtered positions in the window, oldest first, shape (n, 3) [m]."""
        return self._positions[self._first : self._end].copy()

    def update(self, t: float, position: Vector) -> Motion | None:
        """Add a sample measured at ``t`` [s], later than the last.

        Returns
        -------
        Motion or None
            None while the window does not determine the regression.
        """
        reach = self._reach.update(t, position)
        filtered = self._filter.update(t, position)
        self._append(t, filtered)
        coefficients = np.empty((3, 3))
        first, end = self._first, self._end
        future, future_velocity = np.empty((2, len(self._steps), 3))
        speed = predict(
            self._times[first:end], self._positions[first:end], self._steps,
            coefficients, future, future_velocity,
        )  # fmt: skip
        if math.isnan(speed):
            return None
        peak = max(self._speeds[first : end - 1].tolist(), default=-1.0)
        self._speeds[end - 1] = speed
        return Motion(
            t=t,
            position=self._positions[end - 1].copy(),
            coefficients=coefficients,
            velocity=coefficients[1],
            speed=speed,
            window_peak_speed=peak if peak >= 0.0 else None,
            future=future,
            future_velocity=future_velocity,
            reach=reach,
        )

    def _append(self, t: float, position: Vector) -> None:
        if self._end == len(self._times):
            kept = self._end - self._first
            for buffer in (self._times, self._positions, self._speeds):
                buffer[:kept] = buffer[self._first : self._end]
            self._first, self._end = 0, kept
        self._times[self._end] = t
        self._positions[self._end] = position
        self._speeds[self._end] = -1.0  # no regression, no speed
        self._end += 1
        oldest = t - self._config.window_duration
        while self._end - self._first > self._config.window or self._times[self._first] < oldest:
            self._first += 1
