"""Which measurements may be believed: old, future, jumping, frozen, far and lost ones are named.

Every rule reads data times alone; the core has no other clock (DESIGN §3).
"""

from __future__ import annotations

import math
from collections import Counter
from typing import Literal, NamedTuple

from igrip.entities import Vector
from igrip.settings import Settings, quantity


class HealthConfig(Settings):
    """Limits beyond which an input is not believed."""

    future_tolerance: float = quantity(
        0.05, "s", "a measurement may precede its message's arrival by this much", "guess", ge=0
    )
    restart_after: float = quantity(
        0.3, "s", "a stream refused for this long starts anew", "DESIGN §3", gt=0
    )
    hand_limit: float = quantity(
        0.3, "s", "a hand not measured for this long is lost", "SPEC §9", gt=0
    )
    object_limit: float = quantity(
        2.0, "s", "the pose of an object is usable for this long", "DESIGN §5", gt=0
    )
    jump_distance: float = quantity(
        0.10, "m", "a step larger than this plus jump_speed · dt is a jump", "guess", gt=0
    )
    jump_speed: float = quantity(
        5.0, "m/s", "see jump_distance; reaches peak below 3 m/s", "guess", gt=0
    )
    frozen_after: float = quantity(
        0.5,
        "s",
        "a hand that repeats one position bit for bit for this long is frozen",
        "guess",
        gt=0,
    )
    range_limit: float = quantity(100.0, "m", "nothing is further from the origin", "guess", gt=0)


class Verdict(NamedTuple):
    """What to do with one measurement.

    Attributes
    ----------
    action : str
        ``accept``; ``restart``: accept, forgetting what came before; ``ignore``: as if it had not
        come; ``refuse``: not believed, and the entity is invalid.
    reason : str or None
        In words, unless accepted.
    """

    action: Literal["accept", "restart", "ignore", "refuse"]
    reason: str | None = None


class Gate:
    """Judges the measurements of one entity.

    Parameters
    ----------
    config : HealthConfig
        The limits.
    limit : float
        After a gap longer than this the entity starts anew [s].

    Attributes
    ----------
    newest : float
        Time of the newest accepted measurement [s]; NaN before the first.
    counts : Counter
        How many measurements were ``older``, ``future``, ``jump`` or ``far``, and ``restarts``.
    """

    def __init__(self, config: HealthConfig, limit: float) -> None:
        self._config = config
        self._limit = limit
        self._position: Vector | None = None
        self._refused_since: float | None = None
        self._same_since = math.nan
        self.newest = math.nan
        self.counts: Counter[str] = Counter()

    def judge(self, now: float, t: float, position: Vector) -> Verdict:
        """Judge a measurement taken at ``t`` that arrived at ``now`` [s]."""
        config = self._config
        if t > now + config.future_tolerance:
            self.counts["future"] += 1
            return Verdict("refuse", f"measured {t - now:.3g} s in the future of its arrival")
        if max(map(abs, position)) > config.range_limit:
            self.counts["far"] += 1
            return Verdict(
                "refuse", f"is more than {config.range_limit:g} m away: is its unit the metre?"
            )
        if self._position is None:
            return self._take(t, position, "accept")
        if t <= self.newest:
            self.counts["older"] += 1
            return self._doubt(now, t, position, Verdict("ignore", "older than the newest"))
        dt = t - self.newest
        step = math.dist(position, self._position)
        if step > config.jump_distance + config.jump_speed * dt:
            self.counts["jump"] += 1
            reason = f"jumped {step:.2f} m in {dt:.3f} s"
            return self._doubt(now, t, position, Verdict("refuse", reason))
        return self._take(t, position, "restart" if dt > self._limit else "accept")

    def is_late(self, now: float) -> bool:
        """Whether the newest measurement is older than the limit."""
        return not now - self.newest <= self._limit

    def frozen(self) -> str | None:
        """Say so if the position has not changed in a single bit for too long."""
        for_how_long = self.newest - self._same_since
        if for_how_long < self._config.frozen_after:
            return None
        return f"frozen: the same position to the last bit for {for_how_long:.2f} s"

    def _doubt(self, now: float, t: float, position: Vector, verdict: Verdict) -> Verdict:
        """Refuse a measurement, unless the stream has been refused for so long that it is new."""
        if self._refused_since is None:
            self._refused_since = now
        if now - self._refused_since < self._config.restart_after:
            return verdict
        return self._take(t, position, "restart")

    def _take(self, t: float, position: Vector, action: Literal["accept", "restart"]) -> Verdict:
        if action == "restart":
            self.counts["restarts"] += 1
        if action == "restart" or position != self._position:
            self._same_since = t
        self.newest, self._position, self._refused_since = t, position, None
        return Verdict(action)
