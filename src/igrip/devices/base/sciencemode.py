"""Packets of Hasomed's ScienceMode 2 and 4, decoded independently of the vendors' libraries.

A packet begins with F0 and ends with 0F; in between, F0, 0F and 81 are sent as 81 and the byte
xor 55. ScienceMode 2 has a CRC-8 and a length of one byte each, ScienceMode 4 a length and a
CRC-16 of two.
"""

from __future__ import annotations

import binascii
from typing import NamedTuple

START, END, STUFF, KEY = 0xF0, 0x0F, 0x81, 0x55
INIT, INIT_ACK, WATCHDOG, GET_MODE = 1, 2, 4, 10
SET_UP, START_STIMULATION, STOP_STIMULATION, STIMULATION_ERROR = 30, 32, 34, 38
ML_INIT, ML_UPDATE, ML_STOP, ML_CURRENT_DATA = 30, 32, 34, 36
LL_CONFIG = 2


class Packet(NamedTuple):
    """A packet without its frame."""

    number: int
    command: int
    data: bytes


def crc8(data: bytes) -> int:
    """Return the CRC-8 (polynomial 0x07, initial value 0)."""
    register = 0
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ 0x07) & 0xFF if register & 0x80 else register << 1
    return register


def stuff(data: bytes) -> bytes:
    """Return data in which no byte is one that frames packets."""
    return b"".join(
        bytes((STUFF, byte ^ KEY)) if byte in (START, END, STUFF) else bytes((byte,))
        for byte in data
    )


def unstuff(data: bytes) -> bytes:
    """Return what :meth:`stuff` was given."""
    plain, key = bytearray(), 0
    for byte in data:
        if byte == STUFF and not key:
            key = KEY
        else:
            plain.append(byte ^ key)
            key = 0
    return bytes(plain)


def encode2(packet: Packet) -> bytes:
    """Return a packet of ScienceMode 2."""
    body = stuff(bytes((packet.number & 0xFF, packet.command)) + packet.data)
    head = bytes((START, STUFF, crc8(body) ^ KEY, STUFF, len(body) ^ KEY))
    return head + body + bytes((END,))


def decode2(whole: bytes) -> Packet | None:
    """Return the packet in a frame of ScienceMode 2; None if it is damaged."""
    if len(whole) < 8 or whole[1] != STUFF or whole[3] != STUFF:
        return None
    body = whole[5:-1]
    if whole[4] ^ KEY != len(body) or whole[2] ^ KEY != crc8(body):
        return None
    plain = unstuff(body)
    return Packet(plain[0], plain[1], plain[2:]) if len(plain) >= 2 else None


def encode4(packet: Packet) -> bytes:
    """Return a packet of ScienceMode 4."""
    head = ((packet.number & 0x3F) << 10 | packet.command & 0x3FF).to_bytes(2, "big")
    body = stuff(head + packet.data)
    fields = (len(body) + 10).to_bytes(2, "big") + binascii.crc_hqx(body, 0).to_bytes(2, "big")
    stuffed = b"".join(bytes((STUFF, byte ^ KEY)) for byte in fields)
    return bytes((START,)) + stuffed + body + bytes((END,))


def decode4(whole: bytes) -> Packet | None:
    """Return the packet in a frame of ScienceMode 4; None if it is damaged."""
    if len(whole) < 12 or any(whole[k] != STUFF for k in (1, 3, 5, 7)):
        return None
    body = whole[9:-1]
    length, crc = (whole[2] ^ KEY) << 8 | whole[4] ^ KEY, (whole[6] ^ KEY) << 8 | whole[8] ^ KEY
    if length != len(whole) or crc != binascii.crc_hqx(body, 0):
        return None
    plain = unstuff(body)
    if len(plain) < 2:
        return None
    head = int.from_bytes(plain[:2], "big")
    return Packet(head >> 10, head & 0x3FF, plain[2:])


class Frames:
    """Cuts a stream of bytes at its frames, for a bounded number of bytes."""

    MAX = 512

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """Return the frames that are complete; F0 begins one, 0F ends it."""
        found = []
        for byte in data:
            if byte == START:
                self._buffer = bytearray((byte,))
            elif self._buffer:
                self._buffer.append(byte)
                if byte == END:
                    found.append(bytes(self._buffer))
                    self._buffer.clear()
                elif len(self._buffer) > self.MAX:
                    self._buffer.clear()
        return found


def largest2(data: bytes) -> tuple[float, float]:
    """Return the largest current [mA] and width [µs] that ScienceMode 2 packets would give."""
    current = width = 0.0
    for whole in Frames().feed(data):
        packet = decode2(whole)
        if packet is not None and packet.command == START_STIMULATION:
            for k in range(0, len(packet.data) - 3, 4):
                width = max(width, packet.data[k + 1] << 8 | packet.data[k + 2])
                current = max(current, packet.data[k + 3])
    return current, width


def points4(data: bytes) -> list[tuple[int, float, int]]:
    """Return channel, current [mA] and width [µs] of each point of a mid-level update.

    As the library packs it: a byte of active channels; for each, the ramp (4 bits), the number of
    points less one (4 bits), the period (16 bits), then 4 bytes a point, high byte first: width
    (12 bits), current in half milliamperes plus 300 (10 bits).
    """
    found: list[tuple[int, float, int]] = []
    place = 1
    for channel in range(8):
        if not data or not data[0] >> channel & 1:
            continue
        count = (data[place] >> 4) + 1
        place += 3
        for _ in range(count):
            word = int.from_bytes(data[place : place + 4], "big")
            found.append((channel + 1, ((word >> 10 & 0x3FF) - 300) / 2.0, word >> 20))
            place += 4
    return found


def largest4(data: bytes) -> tuple[float, float]:
    """Return the largest current [mA] and width [µs] that ScienceMode 4 packets would give."""
    current = width = 0.0
    for whole in Frames().feed(data):
        packet = decode4(whole)
        if packet is not None and packet.command == LL_CONFIG:
            return float("inf"), 0.0  # igrip uses no low level: nothing of it may pass
        if packet is not None and packet.command == ML_UPDATE:
            for _, milliamperes, microseconds in points4(packet.data):
                current, width = max(current, abs(milliamperes)), max(width, microseconds)
    return current, width
