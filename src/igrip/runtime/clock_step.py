"""The steps of a sender's clock: a time that disagrees with it, and the messages that follow."""

from __future__ import annotations

import math
import statistics
from collections import deque
from collections.abc import Sequence
from typing import Literal, NamedTuple

STEP_MESSAGES = 6  # messages, the first included, that agree on a time that went back
FORWARD_MESSAGES = 3  # on a time that went ahead, which is safe to believe: ages only grow by it
STEP_SPAN = 0.15  # s over which they agree, by the sender's clock and by arrival
PAUSE_SPAN = 1.5  # s for which the delay must be steady after a pause
STEADY = 0.03  # s
MEMORY = 2.0  # s of messages that are compared while a clock is not followed

Kind = Literal["back", "ahead", "pause"]


class TimedMessage(NamedTuple):
    """When a message was sent, by the sender's clock, and when it arrived [s]."""

    sent: float
    arrived: float

    @property
    def delay(self) -> float:
        """The offset of the clock, and the time on the way [s]."""
        return self.arrived - self.sent


class StepCandidate:
    """A time of the sender that disagrees with the followed clock, and the messages after it.

    Parameters
    ----------
    kind : str
        ``back`` or ``ahead``: the sender's interval shows a step; ``pause``: it was silent.
    first : TimedMessage
        The first message that disagrees.
    excess : float
        Lower bound of the step [s].
    shift : float
        How much later than by the followed clock the first message came [s].
    """

    def __init__(self, kind: Kind, first: TimedMessage, excess: float, shift: float) -> None:
        self.kind, self.excess, self.shift = kind, excess, shift
        self.begin = first.arrived
        self.messages = deque([first])

    def add(self, message: TimedMessage) -> None:
        """Append a message that followed."""
        self.messages.append(message)
        while len(self.messages) > 2 and message.arrived - self.messages[0].arrived > MEMORY:
            self.messages.popleft()

    def agrees(self) -> bool:
        """Whether enough messages follow each other as they arrive."""
        messages = self.messages
        span = messages[-1].arrived - messages[0].arrived
        sent = messages[-1].sent - messages[0].sent
        if self.kind == "ahead":
            return len(messages) >= FORWARD_MESSAGES
        if not sent > 0.0 or abs(sent - span) > 0.5 * sent:
            return False
        if self.kind == "pause":
            return span >= PAUSE_SPAN and self._is_steady()
        # of a slow sender fewer messages have to do
        return sent >= STEP_SPAN and (
            len(messages) >= STEP_MESSAGES or (len(messages) > 2 and span >= 0.5 * MEMORY)
        )

    def _is_steady(self) -> bool:
        messages = list(self.messages)
        begin, end = messages[0].arrived, messages[-1].arrived
        third = (end - begin) / 3.0
        first = min(m.delay for m in messages if m.arrived <= begin + third)
        last = min(m.delay for m in messages if m.arrived >= end - third)
        return abs(first - last) <= STEADY

    def offset(self, usual: Sequence[float]) -> float:
        """Return the offset that the messages show, rather too low: no age must be too small.

        The least delay of a few messages can be a long one. What their median would be over the
        followed clock, with the ``usual`` delays above its offset [s], bounds it from below.
        """
        lowest = self.lowest_delay
        if self.kind == "pause" or not usual:
            return lowest
        delays = [message.delay for message in self.messages]
        return min(lowest, statistics.median(delays) - statistics.median(usual))

    @property
    def lowest_delay(self) -> float:
        """The least delay of the messages [s]."""
        return min(message.delay for message in self.messages)

    def returned(self, shift: float) -> bool:
        """Whether a message later than by the followed clock by ``shift`` [s] is of that clock."""
        return shift > 0.5 * self.shift if self.kind == "ahead" else shift < 0.5 * self.excess

    def describe(self, name: str) -> str:
        """Return what is known of the clock of a sender, as text."""
        size = format_seconds(abs(self.shift))
        if self.kind == "pause":
            return f"{name} is late by {size} since it paused, or its clock was set"
        direction = "back" if self.shift > 0.0 else "ahead"
        return (
            f"the clock of {name} stepped {direction} by about {size}: how old its messages are "
            "is not known yet"
        )


def missing_interval(interval: float, period: float | None, spread: float) -> float:
    """Return by how much at least a sender's interval is too short [s]; 0: it is not.

    Of a regular sender an interval is a multiple of its period, however many messages were lost.
    """
    if period is None:
        return max(0.0, -interval)
    short = period - interval
    if short <= 0.0 and spread < 0.02 * period:
        parts = interval / period
        short = (math.ceil(parts) - parts) * period
        if min(short, period - short) < 0.15 * period:
            return 0.0
    return short if short >= max(0.3 * period, 4.0 * spread) or short > period else 0.0


def format_seconds(seconds: float) -> str:
    """Return a duration as text."""
    return f"{seconds:.3f} s" if seconds < 10.0 else f"{seconds:.6g} s"
