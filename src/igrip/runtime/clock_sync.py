"""The time of a run: when each message arrived, and how old it was by then."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import msgspec

from igrip.entities import Hand, ObjectPose
from igrip.observation import Observation

STEP = 1.0  # s by which a sender's times must go back for its clock to have been set anew
STEP_MESSAGES = 8  # messages in a row that show it before a clock counts as set anew
MAX_DRIFT = 1e-3  # s per second by which a sender's clock may fall behind; more is lateness


class ClockOffset:
    """The offset of one sender's clock from that of the run.

    It is the smallest difference between arrival and the sender's own time. So a constant delay
    on the way cannot be seen; one that grows is seen as age, however much it grows. Only times
    that go back for several messages are those of another clock.
    """

    def __init__(self) -> None:
        self._offset = math.nan
        self._newest = -math.inf
        self._arrived = -math.inf
        self._behind = 0

    def update(self, sent: float, arrived: float) -> float:
        """Return the offset after a message [s]."""
        delay = arrived - sent
        self._behind = self._behind + 1 if sent < self._newest - STEP else 0
        if math.isnan(self._offset) or self._behind >= STEP_MESSAGES:
            self._offset, self._newest, self._behind = delay, sent, 0
        drift = MAX_DRIFT * max(0.0, arrived - self._arrived)
        self._offset = min(self._offset + drift, delay)
        self._newest, self._arrived = max(self._newest, sent), arrived
        return self._offset


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
        """Return a message dated by its arrival; its entities keep their ages."""
        self._newest = max(arrived, self._newest)  # it may have arrived just before a tick
        return restamp(message, self._newest, offset.update(message.t, self._newest))


class SenderClock(RunClock):
    """The clock of a single sender, such as a recording that is piped in.

    No time passes between its messages: neither silence nor slow processing makes one older. A
    clock that was set back goes on from where it was, once several messages in a row say so.
    """

    ticks = False

    def __init__(self) -> None:
        super().__init__()
        self._offset = 0.0
        self._behind = 0

    def now(self) -> float:
        """Return the newest time that the sender gave [s]."""
        return self._newest

    def stamp(self, message: Observation, arrived: float, offset: ClockOffset) -> Observation:
        """Return a message as it is dated; a late one keeps its time as that of measurement."""
        t = message.t + self._offset
        self._behind = self._behind + 1 if t < self._newest - STEP else 0
        if self._behind >= STEP_MESSAGES:
            self._offset, self._behind = self._newest - message.t, 0
            t = self._newest
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

    return Observation(
        t=t,
        hands={id: moved(hand) for id, hand in message.hands.items()},
        objects={id: moved(pose) for id, pose in message.objects.items()},
    )
