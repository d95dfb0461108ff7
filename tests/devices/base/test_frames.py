"""Frames against a CRC of another kind, and against damage."""

from __future__ import annotations

import random

from igrip.devices.base.frames import ALLOW, Allow, Frame, FrameReader, is_newer


def crc(data: bytes) -> int:
    """CRC-16/CCITT bit by bit, from its definition."""
    register = 0xFFFF
    for byte in data:
        for bit in range(8):
            top = (register >> 15) ^ (byte >> (7 - bit)) & 1
            register = (register << 1) & 0xFFFF ^ (0x1021 if top else 0)
    return register


def test_the_crc_is_that_of_the_catalogue():
    assert crc(b"123456789") == 0x29B1  # CRC-16/IBM-3740 in Greg Cook's catalogue
    frame = Frame(7, ALLOW, Allow(120, 1, 0, 200).pack()).encode()
    assert int.from_bytes(frame[-2:], "big") == crc(frame[1:-2])


def test_frames_are_found_whatever_the_pieces_and_the_noise():
    random.seed(1)
    reader, sent, found, stream = FrameReader(), [], [], b""
    for number in range(500):
        stream += bytes(random.choices([0xA5, 0, 5, 255, 17], k=random.randrange(6)))
        frame = Frame(number & 255, ALLOW, random.randbytes(random.randrange(33)))
        sent.append(frame)
        stream += frame.encode() + b"\0" * 40  # what a false A5 swallows
    while stream:
        size = random.randint(1, 60)
        found += reader.feed(stream[:size])
        stream = stream[size:]
    assert [f for f in found if f in sent] == sent


def test_no_damaged_frame_is_taken():
    whole = Frame(1, ALLOW, Allow(120, 1, 0, 200).pack()).encode()
    for place in range(len(whole) * 8):  # every single bit, and every burst of up to 16
        for pattern in (1, 3, 0x81, 0xFFFF):
            number = int.from_bytes(whole, "big") ^ (pattern << place)
            data = (number & (1 << len(whole) * 8) - 1).to_bytes(len(whole), "big")
            if data != whole:
                assert FrameReader().feed(data + b"\0" * 40) == []


def test_sequence_numbers_wrap():
    assert is_newer(0, 255)
    assert is_newer(100, 0)
    assert not is_newer(5, 5)
    assert not is_newer(255, 0)
