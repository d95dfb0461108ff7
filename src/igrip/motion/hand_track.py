"""One hand as it is seen over time: its motion, its status and the reason for it."""

from __future__ import annotations

import math

from igrip.entities import Hand
from igrip.gating import Gate, GatingConfig
from igrip.intention import Status
from igrip.motion.trajectory import Motion, MotionConfig, Trajectory


class HandTrack:
    """Health and motion of one hand.

    Attributes
    ----------
    id : str
        Its id in the messages.
    motion : Motion or None
        At its newest believed measurement; None while that does not suffice for a prediction.
    """

    def __init__(self, id: str, config: MotionConfig, health: GatingConfig) -> None:
        self.id = id
        self.gate = Gate(health, health.hand_limit)
        self.trajectory = Trajectory(config)
        self.motion: Motion | None = None
        self._limit = health.hand_limit
        self._refusal: str | None = None
        self._refused_at = 0.0
        self._last_refused = -math.inf
        self._late = False
        self.same_as: str | None = None  # the other hand that is at the same place, if any

    def update(self, now: float, hand: Hand) -> bool:
        """Take a measurement that arrived at ``now`` [s]; return whether it counts as one."""
        t = now if hand.t is None else hand.t
        verdict = self.gate.judge(now, t, hand.position)
        if verdict.action == "ignore":
            return False
        self._refusal, self._refused_at = verdict.reason, now
        if verdict.action == "refuse":
            self._last_refused = now
            return True
        if verdict.action == "restart":
            self.trajectory.reset()
        self.motion = self.trajectory.update(self.gate.newest, hand.position)
        return True

    def advance(self, now: float) -> None:
        """Note that the time is ``now`` [s]."""
        self._late = self.gate.is_late(now)
        if now - self._refused_at > self._limit:
            self._refusal = None  # long ago: what matters now is that nothing comes

    @property
    def status(self) -> Status:
        """What the hand is doing, as far as its input tells."""
        if self._refusal is not None:
            return "invalid"
        if self._late:
            return "lost"
        if self.motion is None:
            return "warming_up"
        return "idle" if self.motion.reach.phase == "rest" else "reaching"

    def reason(self, now: float) -> str | None:
        """Why there is no answer for this hand, or what is wrong with its input, in words."""
        if self._refusal is not None:
            return self._refusal
        if self._late:
            if math.isnan(self.gate.newest):
                return "never measured in a way that could be believed"
            return f"not measured for {now - self.gate.newest:.2f} s"
        if self.motion is None:
            return f"{len(self.trajectory)} samples do not determine a prediction yet"
        if self.same_as is not None:
            return f"contradictory: is where hand {self.same_as} is"
        return self.gate.remark()

    @property
    def trusted(self) -> bool:
        """Whether a device may act on it: it is measured, and nothing is odd about that."""
        fine = self.gate.remark() is None and self.same_as is None
        return fine and self.status in ("idle", "reaching")

    def is_steady(self, now: float) -> bool:
        """Whether it is measured, and all of that could be believed for a while."""
        return not self._late and now - self._last_refused > self._limit

    @property
    def is_late(self) -> bool:
        """Whether it has not been measured for too long."""
        return self._late
