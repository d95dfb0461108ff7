"""Leases: permission for a device to act on a target, which is earned, kept, paused and ended.

One :class:`Committer` per hand reads the estimate and the state of the input once for each
measurement. It is in one of four states::

             likely enough             for the dwell              stopped at the target
    OPEN ──────────────────► EARNING ───────────────► COMMITTED ────────────────────────► HOLDING
      ▲   another, unlikely     │                         │                                  │
      ├─────────────────────────┘     unlikely, at rest   │     the hand leaves, or the      │
      ├───────────────────────────────  elsewhere, veto  ─┘     device reports open          │
      └──────────────────────────────────────────────────────────────────────────────────────┘

In COMMITTED and HOLDING each trusted measurement of the hand renews the lease while the target is
trusted, too. Otherwise the lease pauses, and after ``max_pause`` it is lost.

What another hand holds gets no lease. If it is let go while this hand is at it, the lease that was
refused begins (docs/two-hands.md).
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from igrip.adaptation import Person, ReachLearner
from igrip.commitment_config import ALL_HANDS, MAX_RAISED, CommitmentConfig
from igrip.entities import Vector
from igrip.evidence import Evidence
from igrip.intention import Commitment

__all__ = ["ALL_HANDS", "CommitmentConfig", "Committer", "Evidence", "State"]

State = Literal["open", "earning", "committed", "holding"]


class _Refused(NamedTuple):
    """A lease that was earned, but not given: another hand holds the object."""

    target: str
    grip: str | None
    holder: str
    likely_at: float  # when the target was last likely enough [s]
    at: float  # when the hand was last at it or likely on its way there [s]

    @property
    def reason(self) -> str:
        """Why, as text."""
        return f"{self.target} is held by {self.holder}"


class Committer:
    """The lease of one hand.

    Parameters
    ----------
    config : CommitmentConfig
        When a lease is given.
    person : Person, optional
        Whose hand it is: the threshold follows their reaches (:mod:`igrip.adaptation`).

    Attributes
    ----------
    state : str
        ``open``, ``earning``, ``committed`` or ``holding``.
    target : str or None
        The object of that state.
    """

    def __init__(self, config: CommitmentConfig, person: Person | None = None) -> None:
        self._config = config
        self._learner = (
            None if person is None
            else ReachLearner(config.adaptation, person, config.holding_distance)
        )  # fmt: skip
        self._vetoed = False
        self._confirmed = False
        self._refused: _Refused | None = None
        self._resting_since = self._updated_at = math.nan
        self._open()

    def _open(self) -> None:
        self.state: State = "open"
        self.target: str | None = None
        self._grip: str | None = None
        self._since = math.nan  # of earning, then of the commitment
        self._valid_at = math.nan  # time of the newest message without a pause
        self._stop_position: Vector | None = None
        self._lapsed = False  # the held object has lost its lease permanently

    @property
    def vetoed(self) -> bool:
        """Whether there is a veto that the hand has not yet rested after."""
        return self._vetoed

    def veto(self) -> None:
        """End the lease now, and give none before the hand has rested."""
        if self._learner is not None:
            self._learner.veto()
        self._open()
        self._vetoed, self._confirmed, self._refused = True, False, None
        self._resting_since = math.nan

    def confirm(self) -> None:
        """Confirm the present reach from outside: no dwell is needed."""
        self._confirmed = True

    @property
    def refused_because(self) -> str | None:
        """Why a likely target gets no lease, as text; None: it is not refused."""
        return None if self._refused is None else self._refused.reason

    def reject(self) -> None:
        """Handle a measurement that cannot be trusted: the dwell starts anew."""
        if self.state == "earning":
            self._open()

    def notify_released(self) -> None:
        """Handle the opening of the device: the hand holds nothing any more."""
        if self.state == "holding":
            self._open()

    def update(self, evidence: Evidence) -> Commitment | None:
        """Return the lease after a message, None for no permission.

        Parameters
        ----------
        evidence : Evidence
            Not older than the last.
        """
        config, now = self._config, evidence.t
        paused = self.target is not None and not now - self._valid_at <= config.max_pause
        self._lapsed |= paused and self.state == "holding"
        if paused and self.state != "holding":
            self._open()
        if self._has_rested(evidence):
            self._vetoed = False
            self._confirmed &= self.state != "open"
        valid_until = evidence.measured + config.lease_duration
        if not evidence.trusted or valid_until <= now:
            self.reject()
            return None
        if self.state in ("committed", "holding"):
            self._keep(evidence)
        if self.state in ("open", "earning"):
            self._earn(evidence)
        if self._learner is not None:
            self._learner.update(evidence, self.target if self.state == "committed" else None)
        leased = self.state in ("committed", "holding")
        if not leased or self.target not in evidence.trusted_objects:
            return None
        self._valid_at = now
        assert self.target is not None
        updated = self.state == "committed" and evidence.target == self.target
        if updated and evidence.grip is not None:
            self._grip = evidence.grip
        if self._grip is None or self._lapsed:
            return None
        return Commitment(
            target=self.target, grip=self._grip, since=self._since, valid_until=valid_until
        )

    def _threshold(self, evidence: Evidence) -> float:
        """Return the confidence from which this person's target is committed to."""
        threshold = self._config.threshold_in(evidence.familiarity)
        if self._learner is None or self._learner.person.margin == 0.0:
            return threshold
        margin = self._learner.person.margin
        return min(threshold + margin, max(threshold, MAX_RAISED))

    def _has_rested(self, evidence: Evidence) -> bool:
        """Return whether the hand has rested for long enough, trusted and without a gap."""
        now, config = evidence.t, self._config
        if not evidence.trusted or evidence.moving:
            self._resting_since = math.nan
        elif not now - self._updated_at <= config.max_pause or math.isnan(self._resting_since):
            self._resting_since = now
        self._updated_at = now
        return now - self._resting_since >= config.veto_rest_duration

    def _earn(self, evidence: Evidence) -> None:
        """Start or continue the dwell of a likely target, and commit to it after that.

        A hand that carries an object is occupied: it gets no commitment.
        """
        if self._refused is not None and self._wait(evidence, self._refused):
            return
        config, target = self._config, evidence.target
        full = any(
            evidence.distances.get(id, math.inf) <= config.holding_distance
            for id in evidence.carried
        )
        likely = (
            evidence.moving and not self._vetoed and not full
            and target is not None and evidence.grip is not None
            and target in evidence.trusted_objects
            and evidence.confidence.get(target, 0.0) >= self._threshold(evidence)
        )  # fmt: skip
        if likely and target in evidence.held:
            assert target is not None
            self._refused = _Refused(
                target, evidence.grip, evidence.held[target], evidence.t, evidence.t
            )
            likely = False
        if not likely:
            self._open()
            return
        self._refused = None
        if target != self.target:
            self._open()
            self.state, self.target, self._since = "earning", target, evidence.measured
        self._valid_at = evidence.t
        waited = evidence.measured - self._since >= config.dwell - 1e-9
        if self._confirmed or (waited and not config.needs_confirmation):
            self.state, self._since, self._grip = "committed", evidence.t, evidence.grip
            self._confirmed = False  # the next reach must be confirmed again

    def _wait(self, evidence: Evidence, refused: _Refused) -> bool:
        """Give the lease that was refused once its object is free; return whether it was given.

        The hand must be at the object, on no other way, and have nothing else in it. What was
        refused is forgotten after ``max_pause`` away from the object, or ``max_wait`` at it.
        """
        config, id, now = self._config, refused.target, evidence.t
        near = evidence.distances.get(id, math.inf) <= config.holding_distance
        if near:
            self._refused = refused = refused._replace(at=now)
        if now - refused.at > config.max_pause or now - refused.likely_at > config.max_wait:
            self._refused = None
            return False
        stays = not evidence.moving or evidence.target == id or id in evidence.carried
        ready = (
            near and stays and id not in evidence.held and id in evidence.trusted_objects
            and not self._vetoed and all(
                evidence.distances.get(other, math.inf) > config.holding_distance
                for other in evidence.carried if other != id
            )
            and (self._confirmed or not config.needs_confirmation)
        )  # fmt: skip
        if not ready:
            return False
        self._open()
        self._refused, self._confirmed = None, False
        self.state, self.target, self._since = "committed", id, evidence.t
        self._grip, self._valid_at = refused.grip, evidence.t
        if not evidence.moving:
            self.state, self._stop_position = "holding", evidence.position
        return True

    def _keep(self, evidence: Evidence) -> None:
        """End a commitment or a hold that is over."""
        config = self._config
        assert self.target is not None
        if self.target in evidence.held:  # another hand was faster, or has taken it over
            self._open()
            return
        distance = evidence.distances.get(self.target, math.inf)
        if self.state == "committed":
            if not evidence.moving:
                if distance <= config.holding_distance:
                    self.state, self._stop_position = "holding", evidence.position
                else:
                    self._open()
            elif self.target in evidence.trusted_objects:  # a hidden target cannot be judged
                lowest = self._threshold(evidence) - config.hysteresis
                if evidence.confidence.get(self.target, 0.0) < lowest:
                    self._open()
        elif self._has_left(evidence, distance):
            self._open()

    def _has_left(self, evidence: Evidence, distance: float) -> bool:
        """Return whether the hand has left the held object.

        A hand often hides the object it holds, so the object's last pose is no evidence. Only when
        the object is no longer known and the hand is elsewhere, it counts as left.
        """
        config = self._config
        assert self._stop_position is not None
        if self.target in evidence.trusted_objects:
            return distance > config.holding_distance + config.release_margin
        moved = math.dist(evidence.position, self._stop_position) > config.release_margin
        return moved and self.target not in evidence.distances
