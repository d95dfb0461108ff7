"""A virtual Ability Hand: its frames, six joints that move, and the replies of mode 2.

After PSYONIC's "Ability Hand API". The package documents no time after which a silent master stops
the hand, so this twin has none either.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

from igrip.devices.base.twin import OutputLog

FRAME, ESCAPE, MASK = 0x7E, 0x7D, 0x20
POSITION, DUTY, READ = 0x10, 0x40, 0xA0
TO_DEGREES, TO_AMPERES = 150.0 / 32767.0, 1.0 / 620.606079
SPEED = 200.0  # °/s


class AbilityHandTwin(OutputLog):
    """Moves its joints to where it is told.

    Attributes
    ----------
    positions : list of float
        Degrees of index, middle, ring, little finger, thumb flexor and rotator.
    current : float
        That it reports of each motor while it moves [A].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        super().__init__(clock)
        self.positions = [10.0] * 5 + [-10.0]
        self.current = 0.2
        self._goal = list(self.positions)
        self._buffer, self._escaped = bytearray(), False
        self._at = clock()

    def receive(self, data: bytes) -> bytes:
        """Act on each whole frame."""
        reply = self.tick()
        for byte in data:
            if byte == FRAME:
                frame, self._buffer, self._escaped = bytes(self._buffer), bytearray(), False
                reply += self._act(frame)
            elif byte == ESCAPE and not self._escaped:
                self._escaped = True
            elif len(self._buffer) < 64:
                self._buffer.append(byte ^ (MASK if self._escaped else 0))
                self._escaped = False
        return reply

    def _act(self, frame: bytes) -> bytes:
        if len(frame) < 3 or frame[0] != 0x50 or sum(frame) & 0xFF:
            return b""
        kind, mode = frame[1] & 0xF0, frame[1] & 0x0F
        if mode != 2 or (kind != READ and len(frame) != 15):
            return b""
        if kind == POSITION:
            self._goal = [value * TO_DEGREES for value in struct.unpack("<6h", frame[2:14])]
        elif kind == DUTY:  # igrip sends no other duty than none
            self._goal = list(self.positions)
        self._note()
        return self._reply(frame[1])

    def _reply(self, header: int) -> bytes:
        moving = [abs(g - p) > 0.5 for g, p in zip(self._goal, self.positions, strict=True)]
        body = bytearray((header,))
        for position, moves in zip(self.positions, moving, strict=True):
            ampere = self.current if moves else 0.0
            body += struct.pack("<hh", round(position / TO_DEGREES), round(ampere / TO_AMPERES))
        body += struct.pack("<6h", *(0 for _ in range(6))) + b"\0"
        body.append(-sum(body) & 0xFF)
        stuffed = bytearray((FRAME,))
        for byte in body:
            stuffed += bytes((ESCAPE, byte ^ MASK)) if byte in (FRAME, ESCAPE) else bytes((byte,))
        return bytes(stuffed) + bytes((FRAME,))

    def tick(self) -> bytes:
        """Move on."""
        now = self.clock()
        step, self._at = SPEED * (now - self._at), now
        self.positions = [
            p + max(-step, min(step, g - p))
            for p, g in zip(self.positions, self._goal, strict=True)
        ]
        self._note()
        return b""

    def _note(self) -> None:
        closing = any(
            abs(g) > abs(p) + 0.5 for p, g in zip(self.positions, self._goal, strict=True)
        )
        self.note(closing, text="closes" if closing else "")
