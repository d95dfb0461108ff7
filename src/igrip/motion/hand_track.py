"""One hand over time: its motion, its status and the reason for it."""

from __future__ import annotations

import math

from igrip.entities import Hand
from igrip.gating import Gate, GatingConfig
from igrip.intention import Status
from igrip.motion.palm_axes import palm_axes
from igrip.motion.trajectory import Motion, MotionConfig, Trajectory


class HandTrack:
    """Gate, trajectory and status of one hand.

    Attributes
    ----------
    id : str
        Its id in the messages.
    gate : Gate
        Decides which measurements are accepted.
    trajectory : Trajectory
        Of the accepted measurements.
    motion : Motion or None
        At its newest accepted measurement; None while there are too few for a prediction.
    same_as : str or None
        Another hand that is at the same place.
    """

    def __init__(self, id: str, config: MotionConfig, gating: GatingConfig) -> None:
        self.id = id
        self.gate = Gate(gating, gating.max_hand_age)
        self.trajectory = Trajectory(config)
        self.motion: Motion | None = None
        self.same_as: str | None = None
        self._max_age = gating.max_hand_age
        self._rejection: str | None = None
        self._decided_at = 0.0
        self._rejected_at = -math.inf
        self._stale = False
        self._not_seen: str | None = None

    def update(self, now: float, hand: Hand) -> bool:
        """Add a measurement that arrived at ``now`` [s]; return whether it was not ignored."""
        self._not_seen = None
        t = now if hand.t is None else hand.t
        verdict = self.gate.check(now, t, hand.position)
        if verdict.action == "ignore":
            return False
        self._rejection, self._decided_at = verdict.reason, now
        if verdict.action == "reject":
            self._rejected_at = now
            return True
        if verdict.action == "restart":
            self.trajectory.reset()
        self.motion = self.trajectory.update(self.gate.newest, hand.position)
        if self.motion is not None and (hand.landmarks or hand.orientation):
            self.motion = self.motion._replace(palm=palm_axes(hand))
        return True

    def reject(self, now: float, reason: str) -> None:
        """Note at ``now`` [s] that a measurement cannot be used."""
        self._rejection, self._decided_at, self._rejected_at = reason, now, now
        self.gate.counts["unusable"] += 1

    def miss(self, reason: str | None = None) -> None:
        """Note that the hand was looked for and not detected, and why, if that is known."""
        self._not_seen = reason
        self.gate.counts["missed"] += 1

    def advance(self, now: float) -> None:
        """Set the time to ``now`` [s]."""
        self._stale = self.gate.is_stale(now)
        if now - self._decided_at > self._max_age:
            self._rejection = None  # long ago: what matters now is that nothing arrives

    @property
    def status(self) -> Status:
        """Status of the hand by its input alone, without what a device holds."""
        if self._rejection is not None:
            return "invalid"
        if self._stale:
            return "lost"
        if self.motion is None:
            return "warming_up"
        return "idle" if self.motion.reach.phase == "rest" else "reaching"

    @property
    def is_followed(self) -> bool:
        """Whether there is a motion of accepted, recent measurements."""
        return self.motion is not None and self._rejection is None and not self._stale

    def reason(self, now: float) -> str | None:
        """Return why there is no estimate, or what is wrong with the input; None if nothing is."""
        if self._rejection is not None:
            return self._rejection
        if self._stale:
            if math.isnan(self.gate.newest):
                return "no trusted measurement yet"
            why = f": {self._not_seen}" if self._not_seen else ""
            return f"not measured for {now - self.gate.newest:.2f} s{why}"
        if self.motion is None:
            return f"{len(self.trajectory)} samples do not determine a prediction yet"
        if self.same_as is not None:
            return f"contradictory: is where hand {self.same_as} is"
        return self.gate.warning

    @property
    def trusted(self) -> bool:
        """Whether a device may act on it: it is followed, and its input is not suspicious."""
        clean = self.gate.warning is None and self.same_as is None
        return clean and self.is_followed

    def is_steady(self, now: float) -> bool:
        """Whether it is measured, and no measurement was rejected for ``max_hand_age``."""
        return not self._stale and now - self._rejected_at > self._max_age

    @property
    def is_stale(self) -> bool:
        """Whether it was not measured for longer than ``max_hand_age``."""
        return self._stale
