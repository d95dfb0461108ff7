"""The times of a recording: put in order where a clock stepped, jumped or began below zero.

Times that step back and stay there go on from where they were; a message that alone is out of
order is left out. The later messages decide, so a few are read ahead.
"""

from __future__ import annotations

import statistics
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import msgspec

from igrip.io.defects import Defect
from igrip.observation import Observation

AHEAD = 6  # messages that are read ahead
AGREEING = 3  # of them that make a step of the clock
MIN_JUMP = 1.0  # s; a gap is named from this on
DEFAULT_PERIOD = 1.0 / 30.0  # s between messages while the usual one is not known

Placed = tuple[str, Observation]
"""A message and its place in the file."""


def order_times(
    messages: Iterable[Placed], note: Callable[[Defect, str], None]
) -> Iterator[Placed]:
    """Yield messages with times that never decrease; ``note`` each repair with its place."""
    source = iter(messages)
    waiting: deque[Placed] = deque()
    steps: deque[float] = deque(maxlen=32)
    last, offset = -1.0, 0.0
    while True:
        while len(waiting) <= AHEAD and (item := next(source, None)) is not None:
            waiting.append(item)
        if not waiting:
            return
        place, message = waiting.popleft()
        t = message.t + offset
        coming = [later.t + offset for _, later in waiting]
        period = statistics.median(steps) if steps else DEFAULT_PERIOD
        if last < 0.0:
            if _is_alone(t, coming, t):
                note(Defect("skipped", "t", f"{t:.6g} s is ahead of all that follow"), place)
                continue
        elif t < last:
            if sum(later < last for later in coming[:AHEAD]) < AGREEING:
                note(Defect("skipped", "t", f"steps back by {last - t:.6g} s"), place)
                continue
            note(
                Defect(
                    "corrected", "t", f"steps back by {last + period - t:.6g} s and stays there"
                ),
                place,
            )
            offset += last + period - t
            t = last + period
        elif t - last > max(MIN_JUMP, 20.0 * period):
            if _is_alone(t, coming, t - 0.5 * (t - last)):
                note(Defect("skipped", "t", f"jumps ahead by {t - last:.6g} s, alone"), place)
                continue
            note(Defect("gap", "t", f"nothing for {t - last:.6g} s"), place)
        if last >= 0.0 and t > last:
            steps.append(t - last)
        last = t
        yield place, move_times(message, offset) if offset else message


def move_times(message: Observation, offset: float) -> Observation:
    """Return a message with all its times moved by ``offset`` [s]."""

    def moved(entity: Any) -> Any:
        if entity is None or entity.t is None:
            return entity
        return msgspec.structs.replace(entity, t=max(0.0, entity.t + offset))

    copy = Observation(
        t=message.t + offset,
        hands={id: moved(hand) for id, hand in message.hands.items()},
        objects={id: moved(pose) for id, pose in message.objects.items()},
    )
    return copy.annotated(message.not_seen, message.invalid)


def _is_alone(t: float, coming: list[float], limit: float) -> bool:
    """Whether the messages that follow are before a limit, with at most one exception."""
    return len(coming) >= AGREEING and sum(later < min(limit, t) for later in coming) >= max(
        AGREEING, len(coming) - 1
    )
