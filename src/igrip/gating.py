"""Which measurements may be believed: old, future, jumping, frozen, far and lost ones are named.

Every rule reads data times alone; the core has no other clock (DESIGN §3).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Literal, NamedTuple

from igrip.entities import Vector
from igrip.settings import Settings, quantity

MIN_STEP = 1e-6  # measurements of one entity are further apart than this, or one of them [s]


class GatingConfig(Settings):
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
    hands_apart: float = quantity(
        0.03, "m", "two palms that are nearer to each other are one hand, seen as two", "guess",
        ge=0,
    )  # fmt: skip
    objects_apart: float = quantity(
        0.005, "m", "two objects that are nearer to each other are one, taken for two", "guess",
        ge=0,
    )  # fmt: skip
    range_limit: float = quantity(100.0, "m", "nothing is further from the origin", "guess", gt=0)


def contradictions(positions: Mapping[str, Vector], apart: float) -> dict[str, str]:
    """Return for each entity that is where another is [m] which that is."""
    found = {}
    ranked = sorted((place, id) for id, place in positions.items())  # by x first
    for k, (place, id) in enumerate(ranked):
        for there, other in ranked[k + 1 :]:
            if there[0] - place[0] >= apart:
                break
            if math.dist(place, there) < apart:
                found[id], found[other] = other, id
    return found


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
    config : GatingConfig
        The limits.
    limit : float
        After a gap longer than this the entity starts anew [s].

    Attributes
    ----------
    position : 3 floats or None
        The newest accepted one [m].
    newest : float
        Time of the newest accepted measurement, on the clock of the messages [s]; NaN before the
        first.
    offset : float
        What is added to the entity's own times, since its clock was seen to step back [s].
    counts : Counter
        How many measurements were ``older``, ``future``, ``jump`` or ``far``, and ``restarts``.
    """

    def __init__(self, config: GatingConfig, limit: float) -> None:
        self._config = config
        self._limit = limit
        self.position: Vector | None = None
        self._rejected_since: float | None = None
        self._rejected_t = -math.inf
        self._first_jump = math.inf
        self._same_since = math.nan
        self.newest = math.nan
        self.offset = 0.0
        self.counts: Counter[str] = Counter()

    def judge(self, now: float, t: float, position: Vector) -> Verdict:
        """Judge a measurement whose own time is ``t`` and that arrived at ``now`` [s].

        If it is accepted, :attr:`newest` is its time on the clock of the messages.
        """
        config = self._config
        if max(map(abs, position)) > config.range_limit:
            self.counts["far"] += 1
            return Verdict(
                "refuse", f"is more than {config.range_limit:g} m away: is its unit the metre?"
            )
        latest = now + config.future_tolerance
        if self.offset and t + self.offset > latest >= t:  # its clock stepped forward again
            return self._follow(now, t, position)
        own, t = t, t + self.offset
        if t > latest:
            self.counts["future"] += 1
            return Verdict("refuse", f"measured {t - now:.3g} s in the future of its arrival")
        if self.position is None:
            return self._take(t, position, "accept")
        dt = t - self.newest
        if dt < MIN_STEP:
            self.counts["older"] += 1
            if not self._is_new_stream(now, own):
                return Verdict("ignore", "not newer than the newest")
            return self._follow(now, own, position)
        step = math.dist(position, self.position)
        # while a jump is doubted the bound must not grow until it is believed by patience alone
        since = min(dt, self._first_jump - self.newest)
        if step > config.jump_distance + config.jump_speed * since:
            self.counts["jump"] += 1
            self._first_jump = min(self._first_jump, t)
            if not self._is_new_stream(now, own):
                return Verdict("refuse", f"jumped {step:.2f} m in {dt:.3f} s")
            return self._take(t, position, "restart")
        return self._take(t, position, "restart" if dt > self._limit else "accept")

    def is_late(self, now: float) -> bool:
        """Whether the newest measurement is older than the limit."""
        return not now - self.newest <= self._limit

    def remark(self) -> str | None:
        """Say in words what is odd about measurements that were accepted."""
        if self.offset:
            return f"its clock stepped back by {self.offset:.2f} s; ages are counted from then"
        for_how_long = self.newest - self._same_since
        if not for_how_long >= self._config.frozen_after:  # NaN before the first measurement
            return None
        return f"frozen: the same position to the last bit for {for_how_long:.2f} s"

    def _follow(self, now: float, own: float, position: Vector) -> Verdict:
        """Start anew on the entity's clock as it is now; without an offset where it is in time."""
        self.offset = 0.0 if now - own <= self._limit else now - own
        return self._take(own + self.offset, position, "restart")

    def _is_new_stream(self, now: float, own: float) -> bool:
        """Whether measurements have been doubted for so long that they are a stream of their own.

        Its times must grow: a pose that is sent again and again with its old time is no stream.
        """
        grows, self._rejected_t = own > self._rejected_t, own
        if not grows:
            self._rejected_since = None
        if self._rejected_since is None:
            self._rejected_since = now
        return now - self._rejected_since >= self._config.restart_after

    def _take(self, t: float, position: Vector, action: Literal["accept", "restart"]) -> Verdict:
        if action == "restart":
            self.counts["restarts"] += 1
        if action == "restart" or position != self.position:
            self._same_since = t
        self.newest, self.position = t, position
        self._rejected_since, self._rejected_t, self._first_jump = None, -math.inf, math.inf
        return Verdict(action)
