"""Intentions as other programs get them: numbered, with their age, and for how long a lease holds.

A receiver's clock is another one, so the end of a lease is told as ``valid_for``, seconds from
receipt. It is written at the last moment before a message leaves, so that waiting in a queue is
taken off; ``sent``, the clock of the service then, lets a receiver take off how much longer than
others a message was under way.
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import msgspec

from igrip.intention import Intention

Clock = Callable[[], float]


@dataclass(frozen=True)
class Envelope:
    """An intention on its way.

    Attributes
    ----------
    intention : Intention
        What is said.
    session : str
        Of this run of the service; another one begins its ``seq`` anew.
    seq : int
        Grows by one with each intention of a session: a gap tells what was lost.
    arrived : float
        When the message that led to it arrived, on ``clock`` [s].
    clock : function
        A monotonic clock of this machine [s].
    """

    intention: Intention
    session: str
    seq: int
    arrived: float
    clock: Clock = field(default=time.monotonic, repr=False, compare=False)

    def to_dict(self) -> dict[str, Any]:
        """Return the message as it is to be sent now.

        A lease that has ended meanwhile is sent as none.
        """
        message = self.intention.to_dict()
        now = self.clock()
        age = max(0.0, now - self.arrived)
        lease = self.intention.commitment
        left = None if lease is None else lease.valid_until - self.intention.t - age
        if left is not None and left <= 0.0:
            message["commitment"], left = None, None
        return message | {
            "session": self.session, "seq": self.seq, "sent": round(now, 6), "age": round(age, 6),
            "valid_for": None if left is None else round(left, 6),
        }  # fmt: skip

    def to_json(self) -> bytes:
        """Return one line of JSON, without a line break."""
        return msgspec.json.encode(self.to_dict())

    def to_msgpack(self) -> bytes:
        """Return the same as MessagePack."""
        return msgspec.msgpack.encode(self.to_dict())


class Sequencer:
    """Numbers the intentions of one run."""

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self.session = uuid.uuid4().hex[:12]
        self._clock = clock
        self._seq = 0

    def take(self, intention: Intention, arrived: float) -> Envelope:
        """Return the next envelope."""
        self._seq += 1
        return Envelope(intention, self.session, self._seq, arrived, self._clock)
