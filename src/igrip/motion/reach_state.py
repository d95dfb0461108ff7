"""The movement of a hand so far, at one sample."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Phase = Literal["rest", "accelerating", "decelerating"]


class ReachState(NamedTuple):
    """Where a hand is in its movement, at one sample. World frame.

    Attributes
    ----------
    moving : bool
        Whether the hand moves.
    t : float
        Time of the sample [s].
    onset : float
        When the hand last was near its place of rest [s].
    start : (3,)
        Where it rested [m].
    max_speed, max_speed_t : float
        Highest speed of the newest movement, and when it was reached [m/s, s].
    path_length : float
        Length of the path since the onset [m].
    noise_variance : float
        Estimated variance of the samples, each axis [m²].
    position, velocity, acceleration : (3,)
        Of the sample, fitted [m, m/s, m/s²].
    points : (n, 4)
        Rows t, x, y, z since the onset [s, m]; not empty for a resting hand that may have begun to
        move.
    """

    moving: bool
    t: float
    onset: float
    start: Array
    max_speed: float
    max_speed_t: float
    path_length: float
    noise_variance: float
    position: Array
    velocity: Array
    acceleration: Array
    points: Array

    @property
    def may_move(self) -> bool:
        """Whether the hand moves or may have begun to."""
        return len(self.points) > 0

    @property
    def phase(self) -> Phase:
        """``rest``, ``accelerating`` (this sample is the fastest so far) or ``decelerating``."""
        if not self.moving:
            return "rest"
        return "accelerating" if self.max_speed_t == self.t else "decelerating"

    @property
    def elapsed(self) -> float:
        """Time since the onset [s]; 0 at rest."""
        return self.t - self.onset if self.moving else 0.0

    @property
    def peak_speed(self) -> float:
        """Highest speed since the onset [m/s]; 0 at rest."""
        return self.max_speed if self.moving else 0.0
