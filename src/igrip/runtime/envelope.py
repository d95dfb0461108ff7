"""Intentions as other programs get them: numbered, with their age, and how long a lease holds.

A receiver has another clock, so the end of a lease is sent as ``valid_for``, seconds from receipt.
It is computed when a message leaves, so that time in a queue is subtracted. By ``sent``, the
service's clock at that moment, a receiver can subtract how much longer than others a message was
under way.
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import msgspec

from igrip.intention import Intention


@dataclass(frozen=True)
class Envelope:
    """An intention on its way to the outputs."""

    intention: Intention
    session: str  # of this run; another run begins its ``seq`` anew
    seq: int  # grows by one with each intention of a session: a gap shows what was lost
    arrived: float  # when the message that led to it arrived, by ``now`` [s]
    now: Callable[[], float] = field(repr=False, compare=False)  # the time of the run [s]

    def to_dict(self) -> dict[str, Any]:
        """Return the message to send now; a lease that has ended meanwhile is left out."""
        message = self.intention.to_dict()
        age = max(0.0, self.now() - self.arrived)
        lease = self.intention.commitment
        left = None if lease is None else lease.valid_until - self.intention.t - age
        if left is not None and left <= 0.0:
            message["commitment"], left = None, None
        return message | {
            "session": self.session, "seq": self.seq, "sent": round(time.monotonic(), 6),
            "age": round(age, 6), "valid_for": None if left is None else round(left, 6),
        }  # fmt: skip

    def to_json(self) -> bytes:
        """Return one line of JSON, without a line break."""
        return msgspec.json.encode(self.to_dict())

    def to_msgpack(self) -> bytes:
        """Return the same as MessagePack."""
        return msgspec.msgpack.encode(self.to_dict())


class Sequencer:
    """Numbers the intentions of one run, whose time is ``now`` [s]."""

    def __init__(self, now: Callable[[], float]) -> None:
        self.session = uuid.uuid4().hex[:12]
        self.count = 0
        self._now = now

    def wrap(self, intention: Intention, arrived: float) -> Envelope:
        """Return the next envelope."""
        self.count += 1
        return Envelope(intention, self.session, self.count, arrived, self._now)
