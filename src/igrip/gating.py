"""Validation gate: rejects old, future, jumping and far measurements; marks frozen ones.

Every rule uses the times of the data alone; the core has no other clock.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Literal, NamedTuple

from igrip.entities import Vector
from igrip.settings import Settings, quantity

MIN_STEP = 1e-6  # s; measurements of one entity that are nearer in time count as the same


class GatingConfig(Settings):
    """Limits beyond which a measurement is rejected or marked."""

    future_tolerance: float = quantity(
        0.05,
        "s",
        "a measurement may be this much newer than the arrival of its message",
        "guess",
        ge=0,
    )
    restart_after: float = quantity(
        0.3, "s", "a stream that was rejected for this long restarts", "guess", gt=0
    )
    max_hand_age: float = quantity(
        0.3, "s", "a hand that was not measured for this long is lost", "the authors' code", gt=0
    )
    max_object_age: float = quantity(
        2.0, "s", "the pose of an object is used for this long", "guess", gt=0
    )
    jump_distance: float = quantity(
        0.10, "m", "a step larger than this plus jump_speed · dt is a jump", "guess", gt=0
    )
    jump_speed: float = quantity(
        5.0, "m/s", "see jump_distance; reaches peak below 3 m/s", "guess", gt=0
    )
    frozen_after: float = quantity(
        0.5, "s", "a hand that repeats one position bit for bit for this long is frozen", "guess",
        gt=0,
    )  # fmt: skip
    min_hand_separation: float = quantity(
        0.03, "m", "two palms that are nearer to each other are one hand, detected twice", "guess",
        ge=0,
    )  # fmt: skip
    min_object_separation: float = quantity(
        0.005, "m", "two objects that are nearer to each other are one, detected twice", "guess",
        ge=0,
    )  # fmt: skip
    max_range: float = quantity(
        100.0, "m", "a coordinate beyond this is rejected: its unit is hardly the metre", "guess",
        gt=0,
    )  # fmt: skip


def find_coincident(positions: Mapping[str, Vector], min_separation: float) -> dict[str, str]:
    """Return pairs of entities that are at the same place.

    Parameters
    ----------
    positions : mapping of str to 3 floats
        By id [m].
    min_separation : float
        Entities that are nearer to each other than this are at the same place [m].

    Returns
    -------
    dict of str to str
        For each entity of a pair the other one.
    """
    same = {}
    by_x = sorted((position, id) for id, position in positions.items())
    for k, (position, id) in enumerate(by_x):
        for other_position, other in by_x[k + 1 :]:
            if other_position[0] - position[0] >= min_separation:
                break
            if math.dist(position, other_position) < min_separation:
                same[id], same[other] = other, id
    return same


class Verdict(NamedTuple):
    """The decision on one measurement.

    Attributes
    ----------
    action : str
        ``accept``; ``restart``: accept it and forget what came before; ``ignore``: treat it as not
        received; ``reject``: the entity is invalid.
    reason : str or None
        Why it was not accepted, as text.
    """

    action: Literal["accept", "restart", "ignore", "reject"]
    reason: str | None = None


ACCEPTED = {action: Verdict(action) for action in ("accept", "restart")}


class Gate:
    """Validation gate of one entity.

    Parameters
    ----------
    config : GatingConfig
        The limits.
    max_age : float
        An entity that was not measured for longer than this starts anew [s].

    Attributes
    ----------
    position : 3 floats or None
        The newest accepted one [m].
    newest : float
        Time of the newest accepted measurement, on the clock of the messages [s]; NaN before the
        first.
    offset : float
        Added to the entity's own times since its clock stepped back [s].
    counts : Counter
        Number of ``older``, ``future``, ``jump`` and ``far`` measurements, and of ``restarts``.
    """

    def __init__(self, config: GatingConfig, max_age: float) -> None:
        self._config = config
        self._max_age = max_age
        self.position: Vector | None = None
        self._rejected_since: float | None = None
        self._rejected_t = -math.inf
        self._first_jump = math.inf
        self._same_since = math.nan
        self.newest = math.nan
        self.offset = 0.0
        self.counts: Counter[str] = Counter()

    def check(self, now: float, t: float, position: Vector) -> Verdict:
        """Decide on a measurement with its own time ``t`` that arrived at ``now`` [s].

        If it is accepted, :attr:`newest` becomes its time on the clock of the messages.
        """
        config = self._config
        if max(map(abs, position)) > config.max_range:
            self.counts["far"] += 1
            return Verdict(
                "reject", f"is more than {config.max_range:g} m away: is its unit the metre?"
            )
        latest = now + config.future_tolerance
        if self.offset and t + self.offset > latest >= t:  # its clock stepped forward again
            return self._follow_clock(now, t, position)
        own, t = t, t + self.offset
        if t > latest:
            self.counts["future"] += 1
            return Verdict("reject", f"measured {t - now:.3g} s in the future of its arrival")
        if self.position is None:
            return self._accept(t, position, "accept")
        dt = t - self.newest
        if dt < MIN_STEP:
            self.counts["older"] += 1
            if not self._is_new_stream(now, own):
                return Verdict("ignore", "not newer than the newest")
            return self._follow_clock(now, own, position)
        step = math.dist(position, self.position)
        # the bound must not grow while jumps are rejected: waiting alone would let them pass
        since = min(dt, self._first_jump - self.newest)
        if step > config.jump_distance + config.jump_speed * since:
            self.counts["jump"] += 1
            self._first_jump = min(self._first_jump, t)
            if not self._is_new_stream(now, own):
                return Verdict("reject", f"jumped {step:.2f} m in {dt:.3f} s")
            return self._accept(t, position, "restart")
        return self._accept(t, position, "restart" if dt > self._max_age else "accept")

    def is_stale(self, now: float) -> bool:
        """Whether the newest measurement is older than the limit."""
        return not now - self.newest <= self._max_age

    @property
    def warning(self) -> str | None:
        """What is suspicious about the accepted measurements, as text; None if nothing is."""
        if self.offset:
            return f"its clock stepped back by {self.offset:.2f} s; ages are counted from then"
        frozen_for = self.newest - self._same_since
        if not frozen_for >= self._config.frozen_after:  # NaN before the first measurement
            return None
        return f"frozen: the same position to the last bit for {frozen_for:.2f} s"

    def _follow_clock(self, now: float, own: float, position: Vector) -> Verdict:
        """Restart on the entity's clock as it is now, without an offset if it is right."""
        self.offset = 0.0 if now - own <= self._max_age else now - own
        return self._accept(own + self.offset, position, "restart")

    def _is_new_stream(self, now: float, own: float) -> bool:
        """Whether measurements were rejected for so long that they count as a new stream.

        Its times must grow: a pose that is sent repeatedly with its old time is no stream.
        """
        grows, self._rejected_t = own > self._rejected_t, own
        if not grows:
            self._rejected_since = None
        if self._rejected_since is None:
            self._rejected_since = now
        return now - self._rejected_since >= self._config.restart_after

    def _accept(self, t: float, position: Vector, action: Literal["accept", "restart"]) -> Verdict:
        if action == "restart":
            self.counts["restarts"] += 1
        if action == "restart" or position != self.position:
            self._same_since = t
        self.newest, self.position = t, position
        self._rejected_since, self._rejected_t, self._first_jump = None, -math.inf, math.inf
        return ACCEPTED[action]
