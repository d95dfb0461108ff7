"""A virtual microcontroller of the ``serial`` device; it does what examples/serial_device does."""

from __future__ import annotations

from collections.abc import Callable

from igrip.devices.base.frames import (
    ALLOW,
    HELLO,
    MAX_TTL,
    QUERY,
    STATE,
    STOP,
    Allow,
    Frame,
    FrameReader,
    Reported,
    is_newer,
)  # fmt: skip
from igrip.devices.base.twin import OutputLog

HOLDS_AFTER = 0.3  # s of closing until its fingers touch
REPORT_INTERVAL = 0.1  # s


class SerialTwin(OutputLog):
    """Acts on frames that are whole and new, for as long as they allow.

    Attributes
    ----------
    fault : bool
        Set by tests: it reports a fault and does nothing.
    accepted : list of int
        Sequence numbers of the commands that it acted on.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        super().__init__(clock)
        self._reader = FrameReader()
        self._last, self._until, self._since = 0, -1.0, 0.0
        self._reported_at = clock()
        self._condition = self._level = self._sent = 0
        self.fault = False
        self.accepted: list[int] = []

    def receive(self, data: bytes) -> bytes:
        """Act on what has come."""
        reply = self.tick()
        for frame in self._reader.feed(data):
            if frame.type == HELLO:
                self._last = frame.sequence
                self._stop()
            elif not is_newer(frame.sequence, self._last):
                continue
            self._last = frame.sequence
            allow = Allow.unpack(frame.payload) if frame.type == ALLOW else None
            if allow is not None and not self.fault:
                self._allow(allow, frame.sequence)
            elif frame.type == STOP:
                self._stop()
            if frame.type in (ALLOW, STOP, QUERY):
                reply += self._report()
        return reply

    def _allow(self, allow: Allow, sequence: int) -> None:
        now = self.clock()
        self._until = now + min(allow.ttl, MAX_TTL) / 1000.0
        if self._condition == 0:
            self._condition, self._since = 1, now
        if self._condition == 1 and allow.phase == 1 and now - self._since >= HOLDS_AFTER:
            self._condition = 2
        self._level = allow.level
        self.accepted.append(sequence)
        self.note(True, text=f"grip {allow.grip} phase {allow.phase} level {allow.level}")

    def _stop(self) -> None:
        self._condition = self._level = 0
        self._until = -1.0
        self.note(False)

    def tick(self) -> bytes:
        """Stop where nothing is allowed any more."""
        now = self.clock()
        if self.fault or (self._condition in (1, 2) and now >= self._until):
            self._stop()
        if now - self._reported_at < REPORT_INTERVAL:
            return b""
        return self._report()

    def _report(self) -> bytes:
        self._reported_at = self.clock()
        self._sent += 1
        state = Reported(3 if self.fault else self._condition, self._level, self._last)
        return Frame(self._sent, STATE, state.pack()).encode()
