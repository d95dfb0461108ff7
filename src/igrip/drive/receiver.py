"""The receiving end of leases: which message is fresh, and until when it permits something.

The rule is that of ``docs/clients``: a message counts once, in order, and for no longer than 150 ms
from its receipt, less what it took longer than others to come. Where both ends share a clock, what
it took is known.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

MAX_LEASE = 0.15  # s
MAX_SESSIONS = 64  # that have ended and cannot come back


@dataclass(frozen=True)
class Decision:
    """A fresh message about the hand that is assisted.

    Attributes
    ----------
    number : int
        Grows by one with each fresh message.
    until : float
        End of the permission, on the receiver's clock [s]; 0: there is none.
    since : float
        When this lease was first given, on the sender's clock [s]; with session, hand and target
        it names the lease.
    """

    number: int
    session: str
    hand: str
    status: str
    target: str | None
    model: str | None
    grip: str | None
    time_to_contact: float | None
    since: float
    until: float

    @property
    def lease(self) -> tuple[str, str | None, float]:
        """What tells this lease from others."""
        return self.session, self.target, self.since


class Receiver:
    """Reads intentions as they come over the wire.

    Parameters
    ----------
    hand : str
        The hand that is assisted; messages about others are left out.
    clock : function
        A monotonic clock [s].
    same_clock : bool
        Whether ``sent`` of a message is by that clock, too (one machine).

    Attributes
    ----------
    counts : Counter
        ``fresh``, ``repeated`` (late or twice), ``other`` hands, ``malformed``, ``ended`` sessions.
    """

    def __init__(
        self, hand: str, clock: Callable[[], float] = time.monotonic, same_clock: bool = False
    ) -> None:
        self._hand, self._clock, self._same_clock = hand, clock, same_clock
        self._session: str | None = None
        self._ended: dict[str, None] = {}
        self._sequence = 0
        self._min_delay = math.inf
        self._number = 0
        self.counts: Counter[str] = Counter()

    def read(self, message: Any, arrived: float | None = None) -> Decision | None:
        """Return what a message says, if it is fresh and about this hand.

        Parameters
        ----------
        message
            As it was decoded; nothing is assumed of it.
        arrived : float, optional
            When it arrived [s]; by default now. Time in a queue counts against it.
        """
        now = self._clock() if arrived is None else arrived
        try:
            return self._read(message, now)
        except (KeyError, TypeError, ValueError, OverflowError):
            self.counts["malformed"] += 1
            return None

    def _read(self, message: Mapping[str, Any], now: float) -> Decision | None:
        if not isinstance(message, Mapping):
            raise TypeError
        if "session" not in message:  # a reply or a report, not an intention
            self.counts["other"] += 1
            return None
        session, sequence = _text(message["session"]), message["seq"]
        sent, hand = _number(message["sent"]), _text(message["hand"])
        if isinstance(sequence, bool) or not isinstance(sequence, int) or sequence < 1:
            raise ValueError("seq")
        lease, left = message["commitment"], message["valid_for"]
        decision = self._decision(message, lease, left, session)
        if not self._is_new(session, sequence):
            return None
        delay = now - sent
        self._min_delay = 0.0 if self._same_clock else min(self._min_delay, delay)
        late = max(0.0, delay - self._min_delay)
        if hand != self._hand:
            self.counts["other"] += 1
            return None
        self.counts["fresh"] += 1
        self._number += 1
        until = now + min(decision.until, MAX_LEASE) - late if decision.until > 0.0 else 0.0
        if self._same_clock and delay < -0.001:  # sent in the future: it is another clock
            until = 0.0
        return Decision(**{**decision.__dict__, "number": self._number, "until": until})

    def _decision(
        self, message: Mapping[str, Any], lease: Any, left: Any, session: str
    ) -> Decision:
        """Return the content; ``until`` is for how long it permits something."""
        model, contact = message.get("target_model"), message.get("time_to_contact")
        parts: dict[str, Any] = {
            "number": 0, "session": session, "hand": _text(message["hand"]),
            "status": _text(message["status"]),
            "model": None if model is None else _text(model),
            "time_to_contact": None if contact is None else _number(contact),
        }  # fmt: skip
        if lease is None or left is None:
            return Decision(**parts, target=None, grip=None, since=0.0, until=0.0)
        return Decision(
            **parts, target=_text(lease["target"]), grip=_text(lease["grip"]),
            since=_number(lease["since"]), until=max(0.0, _number(left)),
        )  # fmt: skip

    def _is_new(self, session: str, sequence: int) -> bool:
        if session == self._session:
            if sequence <= self._sequence:
                self.counts["repeated"] += 1
                return False
        elif session in self._ended:
            self.counts["ended"] += 1
            return False
        else:
            if self._session is not None:
                self._ended[self._session] = None
                if len(self._ended) > MAX_SESSIONS:
                    del self._ended[next(iter(self._ended))]
            self._session, self._min_delay = session, math.inf
        self._sequence = sequence
        return True


def _text(value: Any) -> str:
    if not isinstance(value, str) or len(value) > 256:
        raise TypeError
    return value


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise TypeError
    return float(value)
