"""Packed pictures, PNG or JPEG: their size is read before they are unpacked."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import RecordingError, requires_extra

MAX_PIXELS = 1 << 26  # of a picture that is read; those of cameras have some 2^20


def unpack_picture(packed: bytes) -> NDArray[Any]:
    """Return a picture: (h, w, 3) uint8 red, green, blue, or (h, w) uint16.

    Raises
    ------
    RecordingError
        If it is no such picture, or too large.
    MissingExtraError
        If OpenCV is not installed.
    """
    with requires_extra("opencv-python-headless", "hands", "packed pictures"):
        import cv2
    width, height = _declared_size(packed)
    if width * height > MAX_PIXELS:
        raise RecordingError(f"data: a picture of {width} × {height} is too large")
    try:
        picture = cv2.imdecode(np.frombuffer(packed, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        picture = None
    if picture is None:
        raise RecordingError("data: is no picture")
    if picture.ndim == 3 and picture.shape[2] == 3 and picture.dtype == np.uint8:
        return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
    if picture.ndim == 2 and picture.dtype == np.uint16:
        return np.asarray(picture)
    raise RecordingError(f"data: is neither colour nor depth: {picture.shape} {picture.dtype}")


def _declared_size(data: bytes) -> tuple[int, int]:
    """Return the width and height that a PNG or JPEG declares, before it is unpacked.

    PNG: ISO/IEC 15948, 11.2.1; JPEG: ITU-T T.81, B.2.2.
    """
    if data[:8] == b"\x89PNG\r\n\x1a\n" and len(data) >= 24:
        width, height = struct.unpack(">II", data[16:24])
        return width, height
    at = 2 if data[:2] == b"\xff\xd8" else len(data)
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4])
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):  # a start of frame
            height, width = struct.unpack(">HH", data[at + 5 : at + 9])
            return width, height
        at += 2 + length
    raise RecordingError("data: is no picture, neither PNG nor JPEG")
