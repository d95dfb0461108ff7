"""Causal detection of the onset, the course and the end of a hand's movement.

A hand moves once it has left the place where it rested by more than the noise of its measurements
explains; a speed alone would take noise at a low rate for movement, and a slow hand for a resting
one. The noise is estimated all the while, the sway while the hand rests
(docs/decisions/0008-movement-by-displacement.md).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Vector
from igrip.motion.reach_kernel import ReachMemory, ReachParameters, ReachState, update_reach
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]


class ReachConfig(Settings):
    """When a movement begins and ends, and how it is smoothed."""

    time_constant: float = quantity(
        0.06, "s", "memory of the fit of position, velocity and acceleration",
        "guess; 0.04-0.15 were tried once on near/far reaches, without a kept record", gt=0,
    )  # fmt: skip
    onset_distance: float = quantity(
        0.008, "m", "a hand moves once it is this far from its place of rest",
        "guess: twice a resting sway", gt=0,
    )  # fmt: skip
    onset_noise_factor: float = quantity(
        4.0, "1", "and at least this many standard deviations of a measurement", "guess", ge=0
    )
    initial_noise: float = quantity(
        0.003, "m", "standard deviation of a measurement, each axis, before any is estimated",
        "guess: hand trackers, 1-5 mm", gt=0,
    )  # fmt: skip
    onset_sway_factor: float = quantity(
        5.0, "1", "and at least this many standard deviations of the sway of a resting hand and of "
        "slow noise", "guess; 4 took 20 % of a rest at 60 Hz for movement", ge=0,
    )  # fmt: skip
    max_onset_sway: float = quantity(
        0.03, "m", "sway and slow noise raise the onset distance to at most this", "guess", ge=0
    )
    rest_time_constant: float = quantity(
        1.0, "s", "memory of the place of rest, and of the noise", "guess", gt=0
    )
    end_time_constant: float = quantity(
        0.10, "s", "memory of the velocity that decides on the end of a movement", "guess", gt=0
    )
    rest_speed: float = quantity(0.04, "m/s", "a slower hand rests", "guess", gt=0)
    rest_speed_fraction: float = quantity(
        0.10, "1", "a hand slower than this part of its peak speed rests", "the authors' code",
        ge=0, lt=1,
    )  # fmt: skip
    rest_noise_factor: float = quantity(
        1.5, "1", "so does one slower than this many standard deviations of a measurement over "
        "end_time_constant", "guess", ge=0,
    )  # fmt: skip
    min_rest_duration: float = quantity(
        0.10, "s", "rest must last this long to end a movement", "guess", ge=0
    )
    max_gap: float = quantity(
        0.5, "s", "after a longer gap the movement before is forgotten "
        "(GatingConfig.max_hand_age resets a hand earlier)", "guess", gt=0,
    )  # fmt: skip


class ReachDetector:
    """Follows one hand from rest through a movement to rest again, at any sampling rate."""

    def __init__(self, config: ReachConfig | None = None) -> None:
        parameters = ReachParameters(**(config or ReachConfig()).model_dump())
        self._memory, self._parameters = ReachMemory.new(parameters), np.array(parameters)

    def update(self, t: float, position: Array | Vector) -> ReachState:
        """Add a sample at ``t`` [s], later than the last; return the movement so far."""
        update_reach(*self._memory, t, *position, self._parameters)
        return ReachState.of(self._memory)
