"""Times of messages that come from other clocks: stamped on arrival, ages kept."""

from __future__ import annotations

import math
from typing import Any

import msgspec

from igrip.entities import Hand, ObjectPose
from igrip.observation import Observation

STEP = 1.0  # s by which a sender's times must go back for its clock to have been set anew
DRIFT = 1e-3  # s a second by which another clock may fall behind; a slower way is none of it
PATIENCE = 8  # messages in a row that lie before the newest before a clock is believed to be new


class ArrivalStamp:
    """Puts the messages of one sender on the clock of this process.

    The least difference between arrival and a sender's own time is taken for the offset of its
    clock: a constant delay of the way cannot be seen, one that grows is seen as age, however much
    it grows. Only times that go back for several messages are those of another clock.
    """

    def __init__(self) -> None:
        self._offset = math.nan
        self._newest = -math.inf
        self._arrived = -math.inf
        self._before = 0

    def stamp(self, message: Observation, now: float) -> Observation:
        """Return a message as it arrived at ``now`` [s]."""
        delay = now - message.t
        self._before = self._before + 1 if message.t < self._newest - STEP else 0
        if math.isnan(self._offset) or self._before >= PATIENCE:
            self._offset, self._newest, self._before = delay, message.t, 0
        self._offset = min(self._offset + DRIFT * max(0.0, now - self._arrived), delay)
        self._newest, self._arrived = max(self._newest, message.t), now
        return restamped(message, now, self._offset)


class SenderStamp:
    """Keeps the times of the sender, whose clock is then the clock; they never decrease.

    In silence no time passes: a sender that can fall silent sends ticks, as live sources do. A
    clock that was set back goes on from where it was, once several messages in a row say so.
    """

    def __init__(self) -> None:
        self._newest = 0.0
        self._offset = 0.0
        self._before = 0

    def stamp(self, message: Observation, now: float) -> Observation:
        """Return a message as its sender dated it; a late one keeps its time as that measured."""
        t = message.t + self._offset
        self._before = self._before + 1 if t < self._newest - STEP else 0
        if self._before >= PATIENCE:
            self._offset, self._before = self._newest - message.t, 0
            t = self._newest
        if t >= self._newest and self._offset == 0.0:
            self._newest = t
            return message
        self._newest = max(t, self._newest)
        return restamped(message, self._newest, self._offset)


def restamped(message: Observation, t: float, offset: float) -> Observation:
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
