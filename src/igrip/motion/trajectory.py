"""Recent trajectory of one hand, and its near future by weighted quadratic regression."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Vector
from igrip.motion.filters import OneEuroConfig, PositionFilter
from igrip.motion.palm_axes import PalmAxes
from igrip.motion.reach_detection import ReachConfig, ReachDetector
from igrip.motion.reach_kernel import ReachState
from igrip.motion.trajectory_kernel import (
    COEFFICIENTS,
    FILTERED,
    FUTURE,
    POSITION,
    SPEED,
    advance,
    new_window,
)
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
        self._reach = ReachDetector(self._config.reach)
        self._filter = PositionFilter(self._config.filter)
        self._window, self._ends = new_window(self._config.window)

    def __len__(self) -> int:
        first, end = self._ends.tolist()
        return int(end - first)

    @property
    def past(self) -> Array:
        """The filtered positions in the window, oldest first, shape (n, 3) [m]."""
        first, end = self._ends.tolist()
        return self._window[first:end, POSITION:SPEED].copy()

    def update(self, t: float, position: Vector) -> Motion | None:
        """Add a sample measured at ``t`` [s], later than the last.

        Returns
        -------
        Motion or None
            None while the window does not determine the regression.
        """
        reach = self._reach.update(t, position)
        ahead = FUTURE + len(self._steps)
        out = np.empty((ahead + len(self._steps), 3))
        speed, peak = advance(
            self._filter.state, self._filter.parameters, self._window, self._ends, t, *position,
            self._config.window_duration, self._steps, out,
        )  # fmt: skip
        if math.isnan(speed):
            return None
        return Motion(
            t=t,
            position=out[FILTERED],
            coefficients=out[COEFFICIENTS:FUTURE],
            velocity=out[COEFFICIENTS + 1],
            speed=speed,
            window_peak_speed=peak if peak >= 0.0 else None,
            future=out[FUTURE:ahead],
            future_velocity=out[ahead:],
            reach=reach,
        )
