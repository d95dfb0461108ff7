"""The framed protocol of the ``serial`` device, for both ends of the line.

A frame is ``A5 | length | sequence | type | payload | CRC``, where ``length`` counts the payload
(0 to 32 bytes) and the CRC is CRC-16/CCITT (polynomial 0x1021, initial value 0xFFFF, high byte
first) of everything between the A5 and itself. docs/devices.md has the payloads, and
examples/serial_device a receiver in C.
"""

from __future__ import annotations

import binascii
import struct
from typing import NamedTuple

START = 0xA5
MAX_PAYLOAD = 32
HELLO, ALLOW, STOP, QUERY, STATE = 0x00, 0x01, 0x02, 0x03, 0x81
MAX_TTL = 150  # ms; a device takes a longer one for this
_ALLOW, _STATE = struct.Struct(">HBBB"), struct.Struct(">BBB")


class Frame(NamedTuple):
    """One message; ``sequence`` is 0 to 255."""

    sequence: int
    type: int
    payload: bytes = b""

    def encode(self) -> bytes:
        """Return its bytes on the line."""
        body = bytes((len(self.payload), self.sequence & 0xFF, self.type)) + self.payload
        return bytes((START,)) + body + struct.pack(">H", binascii.crc_hqx(body, 0xFFFF))


class Allow(NamedTuple):
    """Act for so long and not longer, unless another one comes."""

    ttl: int  # ms
    grip: int  # its number in the configuration
    phase: int  # 0: reach, 1: grasp
    level: int  # 0 to 255

    def pack(self) -> bytes:
        """Return its payload."""
        return _ALLOW.pack(self.ttl, self.grip, self.phase, self.level)

    @classmethod
    def unpack(cls, payload: bytes) -> Allow | None:
        """Read a payload; None if it has another length."""
        return cls(*_ALLOW.unpack(payload)) if len(payload) == _ALLOW.size else None


class Reported(NamedTuple):
    """What a device says of itself."""

    condition: int  # 0: open, 1: closing, 2: holding, 3: fault
    level: int
    sequence: int  # of the newest frame that it accepted

    def pack(self) -> bytes:
        """Return its payload."""
        return _STATE.pack(*self)

    @classmethod
    def unpack(cls, payload: bytes) -> Reported | None:
        """Read a payload; None if it has another length or names no condition."""
        if len(payload) != _STATE.size or payload[0] > 3:
            return None
        return cls(*_STATE.unpack(payload))


class FrameReader:
    """Finds frames in a stream of bytes; whatever is between them is skipped and counted."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self.skipped = 0  # bytes

    def feed(self, data: bytes) -> list[Frame]:
        """Return the frames that are complete with these bytes."""
        self._buffer += data
        frames: list[Frame] = []
        while True:
            begin = self._buffer.find(START)
            drop = len(self._buffer) if begin < 0 else begin
            self.skipped += drop
            del self._buffer[:drop]
            if len(self._buffer) < 2:
                return frames
            length = self._buffer[1]
            whole = length + 6
            if length <= MAX_PAYLOAD and len(self._buffer) < whole:
                return frames
            body = bytes(self._buffer[1 : whole - 2])
            crc = int.from_bytes(self._buffer[whole - 2 : whole], "big")
            if length <= MAX_PAYLOAD and binascii.crc_hqx(body, 0xFFFF) == crc:
                frames.append(Frame(body[1], body[2], body[3:]))
                del self._buffer[:whole]
            else:  # the A5 was none that begins a frame
                self.skipped += 1
                del self._buffer[:1]


def is_newer(sequence: int, than: int) -> bool:
    """Return whether a sequence number follows another one, modulo 256."""
    return 1 <= (sequence - than) & 0xFF <= 127
