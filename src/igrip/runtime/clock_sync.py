"""The time of a run: when each message arrived, and how old it was by then."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import msgspec

from igrip.entities import Hand, ObjectPose
from igrip.observation import Observation
from igrip.runtime.clock_offset import ClockOffset
from igrip.runtime.clock_step import STEP_MESSAGES

__all__ = ["STEP_MESSAGES", "ArrivalClock", "ClockOffset", "RunClock", "SenderClock", "restamp"]

STEP = 0.02  # s by which a sender's times must go back for its clock to have been set anew
MIN_AHEAD = 1.0  # s; a jump ahead is named from this on


class RunClock:
    """The clock of a run: this machine's, for messages that are dated by it already.

    Parameters
    ----------
    begin : float, optional
        When the run begins, on ``clock`` [s]; by default now.
    clock : function
        A monotonic clock [s].

    Attributes
    ----------
    ticks : bool
        Whether time passes in silence, so that the estimator needs ticks.
    """

    ticks = True

    def __init__(
        self, begin: float | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._clock = clock
        self._begin = clock() if begin is None else begin
        self._newest = 0.0

    def now(self) -> float:
        """Return the time since the run began [s]; from any thread."""
        return self._clock() - self._begin

    def stamp(self, message: Observation, arrived: float, offset: ClockOffset) -> Observation:
        """Return a message, sent by a clock with this offset, with its time on the run's clock.

        ``arrived`` is when it arrived, by :meth:`now` [s]. The times never decrease.
        """
        if message.t < self._newest:
            return restamp(message, self._newest, 0.0)
        self._newest = message.t
        return message


class ArrivalClock(RunClock):
    """The clock of this machine, for messages that are dated by other clocks."""

    def stamp(self, message: Observation, arrived: float, offset: ClockOffset) -> Observation:
        """Return a message dated by its arrival; its entities keep their ages.

        Of a clock that is not followed at present the ages are not known: the message is invalid.
        """
        self._newest = max(arrived, self._newest)  # it may have arrived just before a tick
        stamped = restamp(message, self._newest, offset.update(message.t, self._newest))
        return stamped if offset.distrust is None else stamped.annotated(invalid=offset.distrust)


class SenderClock(RunClock):
    """The clock of a single sender, such as a recording that is piped in.

    No time passes between its messages: neither silence nor slow processing makes one older. A
    clock that was set back goes on from where it was, once several messages in a row show it.
    """

    ticks = False

    def __init__(self) -> None:
        super().__init__()
        self._offset = 0.0
        self._behind, self._lag = 0, 0.0  # messages in a row, and by how much at most [s]

    def now(self) -> float:
        """Return the newest time that the sender gave [s]."""
        return self._newest

    def stamp(self, message: Observation, arrived: float, offset: ClockOffset) -> Observation:
        """Return a message as it is dated; a late one keeps its time as that of measurement."""
        t = message.t + self._offset
        behind = t < self._newest - STEP
        self._behind = self._behind + 1 if behind else 0
        self._lag = max(self._lag, self._newest - t) if behind else 0.0
        if self._behind >= STEP_MESSAGES:
            offset.note_step(-self._lag, f"at t = {message.t:.6g}")
            self._offset, self._behind = self._newest - message.t, 0
            t = self._newest
        elif t > self._newest + MIN_AHEAD and self._newest > 0.0:
            offset.note_gap(t - self._newest, f"at t = {message.t:.6g}")
        if t >= self._newest and self._offset == 0.0:
            self._newest = t
            return message
        self._newest = max(t, self._newest)
        return restamp(message, self._newest, self._offset)


def restamp(message: Observation, t: float, offset: float) -> Observation:
    """Return a message that arrives at ``t``, its entities' times moved by ``offset`` [s]."""

    def moved(entity: Hand | ObjectPose | None) -> Any:
        if entity is None:
            return None
        own = message.t if entity.t is None else entity.t
        return msgspec.structs.replace(entity, t=max(0.0, own + offset))

    stamped = Observation(
        t=t,
        hands={id: moved(hand) for id, hand in message.hands.items()},
        objects={id: moved(pose) for id, pose in message.objects.items()},
    )
    return stamped.annotated(not_seen=message.not_seen) if message.not_seen else stamped
