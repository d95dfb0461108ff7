"""Times of messages that come from other clocks: stamped on arrival, ages kept."""

from __future__ import annotations

from collections import deque
from typing import Any

import msgspec

from igrip.entities import Hand, ObjectPose
from igrip.observation import Observation

WINDOW = 10.0  # s over which the least delay of a sender is remembered; clocks drift
STEP = 1.0  # s by which a delay must change for the sender's clock to have been set anew


class ArrivalStamp:
    """Puts the messages of one sender on the clock of this process.

    The least difference between arrival and a sender's own time, of late, is taken for the offset
    of its clock: a constant delay of the way cannot be seen, one that varies is seen as age.
    """

    def __init__(self) -> None:
        self._delays: deque[tuple[float, float]] = deque()

    def stamp(self, message: Observation, now: float) -> Observation:
        """Return a message as it arrived at ``now`` [s]."""
        delay = now - message.t
        if self._delays and abs(delay - self._delays[-1][1]) > STEP:
            self._delays.clear()
        while self._delays and (now - self._delays[0][0] > WINDOW or len(self._delays) > 4096):
            self._delays.popleft()
        # rising from left to right: the first is the least of the window
        while self._delays and self._delays[-1][1] >= delay:
            self._delays.pop()
        self._delays.append((now, delay))
        offset = self._delays[0][1]
        return restamped(message, now, offset)


class SenderStamp:
    """Keeps the times of the sender, whose clock is then the clock; they never decrease.

    In silence no time passes: a sender that can fall silent sends ticks, as live sources do.
    """

    def __init__(self) -> None:
        self._newest = 0.0

    def stamp(self, message: Observation, now: float) -> Observation:
        """Return a message as its sender dated it; a late one keeps its time as that measured."""
        if message.t >= self._newest:
            self._newest = message.t
            return message
        return restamped(message, self._newest, 0.0)


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
