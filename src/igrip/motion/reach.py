"""Is this hand reaching, since when and from where: decided as the samples come (causally)."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from pydantic import model_validator

from igrip.entities import Vector
from igrip.settings import Settings, quantity

Phase = Literal["rest", "accelerating", "decelerating"]


class ReachConfig(Settings):
    """When a movement begins and ends."""

    onset_speed: float = quantity(0.10, "m/s", "above it a movement has begun", "guess", gt=0)
    rest_speed: float = quantity(
        0.05, "m/s", "below it a hand rests; onset is dated back to it", "guess", gt=0
    )
    rest_fraction: float = quantity(
        0.10, "1", "below this part of the peak speed a hand rests", "SPEC §7", ge=0, lt=1
    )
    dwell: float = quantity(0.10, "s", "rest must last this long to end a reach", "guess", ge=0)

    @model_validator(mode="after")
    def _ordered(self) -> ReachConfig:
        if not self.rest_speed <= self.onset_speed:
            raise ValueError("rest_speed must not be more than onset_speed")
        return self


class Reach(NamedTuple):
    """Where a hand is in its movement.

    Attributes
    ----------
    phase : str
        ``rest``, ``accelerating`` (no faster sample yet) or ``decelerating``.
    onset : float
        When the hand last rested [s].
    start : 3 floats
        Where it was then [m].
    elapsed : float
        Time since onset [s]; 0 at rest.
    peak_speed : float
        Highest speed since onset [m/s].
    """

    phase: Phase
    onset: float
    start: Vector
    elapsed: float
    peak_speed: float


class ReachDetector:
    """Follows one hand from rest through a movement to rest again."""

    def __init__(self, config: ReachConfig) -> None:
        self._config = config
        self._moving = False
        self._onset = math.nan
        self._start: Vector = (math.nan, math.nan, math.nan)
        self._peak = 0.0
        self._slow_since: float | None = None

    def update(self, t: float, position: Vector, speed: float) -> Reach:
        """Take a sample at time ``t`` [s], position [m], speed [m/s]."""
        config = self._config
        if not self._moving:
            if math.isnan(self._onset) or speed < config.rest_speed:
                self._onset, self._start = t, position
            if speed <= config.onset_speed:
                return Reach("rest", self._onset, self._start, 0.0, 0.0)
            self._moving, self._peak, self._slow_since = True, 0.0, None
        rising = speed >= self._peak
        self._peak = max(self._peak, speed)
        if speed < max(config.rest_speed, config.rest_fraction * self._peak):
            self._slow_since = t if self._slow_since is None else self._slow_since
            if t - self._slow_since >= config.dwell:
                self._moving = False
                self._onset, self._start = t, position
                return Reach("rest", t, position, 0.0, 0.0)
        else:
            self._slow_since = None
        phase: Phase = "accelerating" if rising else "decelerating"
        return Reach(phase, self._onset, self._start, t - self._onset, self._peak)
