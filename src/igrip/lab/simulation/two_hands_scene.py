"""What truly happens in a scene of two hands: where they are, what they reach for and hold."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from igrip.lab.simulation.minimum_jerk import Array
from igrip.lab.simulation.movement import SimulatedReach
from igrip.lab.simulation.sensors import Poses
from igrip.lab.simulation.table import Table


class Reach(NamedTuple):
    """What one hand reached for, and the bounds of that movement [s]."""

    hand: str
    target: str
    onset: float
    end: float


class Hold(NamedTuple):
    """From when to when a hand truly held an object [s]."""

    hand: str
    object: str
    since: float
    until: float


@dataclass(frozen=True)
class TwoHandsScene:
    """What truly happened in one scene."""

    kind: str
    times: Array  # of the frames, (n,) [s]
    palms: Mapping[str, Array]  # of every hand, (n, 3) [m]
    table: Table
    moving: Mapping[str, Poses]  # objects that do not rest
    reaches: Sequence[Reach]
    holds: Sequence[Hold]

    def held_before(self, hand: str, object: str, t: float) -> bool:
        """Return whether another hand holds an object at ``t`` [s], and did so before this one."""
        own = min((h.since for h in self.holds if h[:2] == (hand, object)), default=math.inf)
        return any(
            h.object == object and h.hand != hand and h.since <= t < h.until and h.since < own
            for h in self.holds
        )

    def free_at(self, hand: str, object: str) -> float | None:
        """Return when the last hand that held an object before this one lets go [s]; or None."""
        until = [
            h.until for h in self.holds
            if h.object == object and self.held_before(hand, object, np.nextafter(h.until, 0.0))
        ]  # fmt: skip
        return max(until, default=None)


class Course:
    """A hand from rest through one movement after another."""

    def __init__(self, start: Array) -> None:
        self.start = start
        self.parts: list[SimulatedReach] = []

    def at(self, t: Array) -> Array:
        """Return the palm at times (n,) [s], shape (n, 3) [m]."""
        palm = np.tile(self.start, (len(t), 1))
        for part in self.parts:
            palm += part.position(t) - part.start
        return palm

    def point(self, t: float) -> Array:
        """Return the palm at one time, shape (3,) [m]."""
        place: Array = self.at(np.array([t]))[0]
        return place
