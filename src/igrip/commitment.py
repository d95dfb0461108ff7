"""When a device may act, on what, and until when: a lease that is earned, kept, paused and ended.

One :class:`Committer` a hand. It reads what the estimator believes and what health says, once for
each measurement, and is one of::

             likely enough             for the dwell              stopped at the target
    OPEN ──────────────────► EARNING ───────────────► COMMITTED ────────────────────────► HOLDING
      ▲   another, unlikely     │                         │                                  │
      ├─────────────────────────┘     unlikely, at rest   │     the hand leaves, or the      │
      ├───────────────────────────────  elsewhere, veto  ─┘     device reports open          │
      └──────────────────────────────────────────────────────────────────────────────────────┘

In COMMITTED and HOLDING a lease is given with each measurement that can be believed and for as
long as the target can be: without either the lease pauses, and after a while is lost.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Container, Mapping, Sequence
from typing import Literal, NamedTuple

from igrip.entities import Vector
from igrip.intention import Commitment
from igrip.settings import Settings, quantity

State = Literal["open", "earning", "committed", "holding"]
ALONG = 0.6  # cosine between the velocities of a hand and of what it carries, at least; guess
EVERY: tuple[str, ...] = ("*",)


class CommitmentConfig(Settings):
    """How surely, how long and for whom.

    Attributes
    ----------
    assisted : tuple of str
        Ids of the hands that a device assists; ``("*",)``: every hand. No other ever commits.
    needs_confirmation : bool
        Whether each reach must be confirmed from outside (a switch, a muscle) to be acted on.
    """

    assisted: tuple[str, ...] = EVERY
    needs_confirmation: bool = False
    reliability: float = quantity(
        0.45, "1", "0: reactive, early and sometimes wrong; 1: reliable, late or not at all",
        "docs/commitment.md", ge=0, le=1,
    )  # fmt: skip
    least: float = quantity(0.5, "1", "confidence asked for at reliability 0", "guess", gt=0, lt=1)
    most: float = quantity(0.98, "1", "confidence asked for at reliability 1", "guess", gt=0, le=1)
    max_dwell: float = quantity(
        0.2, "s", "a target must be likely for this long at reliability 1, at 0 not at all",
        "guess", ge=0,
    )  # fmt: skip
    hysteresis: float = quantity(
        0.25, "1", "a target is kept until it is this much less likely than was asked for",
        "guess", ge=0, lt=1,
    )  # fmt: skip
    lease: float = quantity(
        0.15, "s", "a lease ends so long after the newest measurement of the hand", "DESIGN §5",
        gt=0,
    )  # fmt: skip
    resume: float = quantity(
        0.3, "s", "after a pause no longer than this it goes on without a dwell", "DESIGN §5", ge=0
    )
    rest: float = quantity(
        0.3, "s", "a hand must rest so long, believed, for a veto to be over", "guess", ge=0
    )
    reach: float = quantity(
        0.12, "m", "a palm that stops so near to the surface of its target holds it", "guess", gt=0
    )
    leave: float = quantity(
        0.06, "m", "and lets go where it is so much further from it", "guess", gt=0
    )

    @property
    def threshold(self) -> float:
        """Confidence from which a target is committed to."""
        return self.least + self.reliability * (self.most - self.least)

    @property
    def dwell(self) -> float:
        """For how long it must be so likely [s]."""
        return self.reliability * self.max_dwell

    def assists(self, hand: str) -> bool:
        """Whether a device assists this hand."""
        return self.assisted == EVERY or hand in self.assisted


class Evidence(NamedTuple):
    """What is known of one hand after a message in which it was measured.

    Attributes
    ----------
    t : float
        Time of the message [s].
    measured : float
        Time of the hand's newest believed measurement [s].
    position : 3 floats
        Of the palm, then [m].
    trusted : bool
        Whether health has nothing against the hand.
    moving : bool
        Whether it is in a movement.
    target, grip : str or None
        What the estimator says.
    confidence : mapping of str to float
        Its probability, or score, of each object; where there are any, that of ``none``, too.
    seen : container of str
        Objects that were seen when they were last looked for, and may be believed.
    gaps : mapping of str to float
        Distance of the palm from each object that is known [m].
    carried : container of str
        Objects that move along with the hand.
    """

    t: float
    measured: float
    position: Vector
    trusted: bool
    moving: bool
    target: str | None
    grip: str | None
    confidence: Mapping[str, float]
    seen: Container[str]
    gaps: Mapping[str, float]
    carried: Collection[str] = ()


def moving_along(velocities: Mapping[str, Sequence[float]], velocity: Sequence[float]) -> list[str]:
    """Return which objects move much as a hand does.

    Parameters
    ----------
    velocities : mapping of str to 3 floats
        Of the objects that move, by id [m/s].
    velocity : 3 floats
        Of the hand [m/s].
    """
    speed = math.hypot(*velocity)
    return [
        id for id, own in velocities.items()
        if sum(a * b for a, b in zip(own, velocity, strict=True)) > ALONG * speed * math.hypot(*own)
    ]  # fmt: skip


class Committer:
    """The lease of one hand. Not to be fed but with messages in order of time.

    Attributes
    ----------
    state : str
        ``open``, ``earning``, ``committed`` or ``holding``.
    target : str or None
        That is earned, committed to or held.
    """

    def __init__(self, config: CommitmentConfig) -> None:
        self._config = config
        self._vetoed = False
        self._confirmed = False
        self._rests_since = self._rested = math.nan
        self._open()

    def _open(self) -> None:
        self.state: State = "open"
        self.target: str | None = None
        self._grip: str | None = None
        self._since = math.nan  # of earning, then of the commitment
        self._good = math.nan  # when there last was nothing against it
        self._stopped: Vector | None = None
        self._lapsed = False  # what is held has lost its lease for good

    @property
    def vetoed(self) -> bool:
        """Whether there is a veto that the hand has not yet rested after."""
        return self._vetoed

    def veto(self) -> None:
        """End the lease now, and give none before the hand has rested."""
        self._open()
        self._vetoed, self._confirmed = True, False
        self._rests_since = math.nan

    def confirm(self) -> None:
        """Take the user's word for the reach under way: no dwell."""
        self._confirmed = True

    def doubt(self) -> None:
        """Note a measurement that cannot be believed: what was being earned is earned anew."""
        if self.state == "earning":
            self._open()

    def notify_released(self) -> None:
        """Note that the device has opened: what was held is held no longer."""
        if self.state == "holding":
            self._open()

    def update(self, seen: Evidence) -> Commitment | None:
        """Return the lease after a message; None: no permission."""
        config = self._config
        paused = self.target is not None and not seen.t - self._good <= config.resume
        self._lapsed |= paused and self.state == "holding"
        if paused and self.state != "holding":
            self._open()
        if self._has_rested(seen):
            self._vetoed = False
            self._confirmed &= self.state != "open"
        ends = seen.measured + config.lease
        if not seen.trusted or ends <= seen.t:
            self.doubt()
            return None
        if self.state in ("committed", "holding"):
            self._keep(seen)
        if self.state in ("open", "earning"):
            self._earn(seen)
        if self.state not in ("committed", "holding") or self.target not in seen.seen:
            return None
        self._good = seen.t
        assert self.target is not None
        if self.state == "committed" and seen.grip is not None and seen.target == self.target:
            self._grip = seen.grip
        if self._grip is None or self._lapsed:
            return None
        return Commitment(target=self.target, grip=self._grip, since=self._since, valid_until=ends)

    def _has_rested(self, seen: Evidence) -> bool:
        """Whether a hand has rested, believed all the while; one seen anew seems to, at first."""
        if not seen.trusted or seen.moving:
            self._rests_since = math.nan
        elif not seen.t - self._rested <= self._config.resume or math.isnan(self._rests_since):
            self._rests_since = seen.t
        self._rested = seen.t
        return seen.t - self._rests_since >= self._config.rest

    def _earn(self, seen: Evidence) -> None:
        """Look for a target that is likely enough, for long enough, while the hand moves.

        A hand that carries something is full.
        """
        config, target = self._config, seen.target
        likely = (
            seen.moving and not self._vetoed and target is not None and seen.grip is not None
            and not any(seen.gaps.get(id, math.inf) <= config.reach for id in seen.carried)
            and target in seen.seen and seen.confidence.get(target, 0.0) >= config.threshold
        )  # fmt: skip
        if not likely:
            self._open()
            return
        if target != self.target:
            self._open()
            self.state, self.target, self._since = "earning", target, seen.measured
        self._good = seen.t
        waited = seen.measured - self._since >= config.dwell - 1e-9
        if self._confirmed or (waited and not config.needs_confirmation):
            self.state, self._since, self._grip = "committed", seen.t, seen.grip
            self._confirmed = False  # another reach is to be confirmed anew

    def _keep(self, seen: Evidence) -> None:
        """End what was committed to or held, where it is over."""
        config = self._config
        assert self.target is not None
        gap = seen.gaps.get(self.target, math.inf)
        if self.state == "committed":
            if not seen.moving:
                if gap <= config.reach:
                    self.state, self._stopped = "holding", seen.position
                else:
                    self._open()
            elif self.target in seen.seen:  # what is hidden for a moment cannot be judged
                least = config.threshold - config.hysteresis
                if seen.confidence.get(self.target, 0.0) < least:
                    self._open()
        elif self._left(seen, gap):
            self._open()

    def _left(self, seen: Evidence, gap: float) -> bool:
        """Whether the hand has left what it held.

        An object in a hand is often hidden by it: where it was last seen tells nothing then. Only
        once it is given up and the hand is elsewhere, too, is it taken for left.
        """
        config = self._config
        assert self._stopped is not None
        if self.target in seen.seen:
            return gap > config.reach + config.leave
        away = math.dist(seen.position, self._stopped) > config.leave
        return away and self.target not in seen.gaps
