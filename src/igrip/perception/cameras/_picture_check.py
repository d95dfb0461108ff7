"""Checks of a camera's pictures: black, without depth, or always the same."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.rgbd import RgbdFrame

STRIDE = 8  # pixels between those that are looked at
BLACK = 20  # of 255; 16 is black in video levels, and a covered sensor has a little noise; guess
MIN_LIT = 0.002  # share of pixels over BLACK; with less a picture is black; guess
MIN_DEPTH = 0.005  # share of pixels with depth; with less there is none; guess
DELAY = 1.5  # s until it is mentioned: exposures settle; guess
OPEN_SHUTTER = "open its shutter, uncover the lens, and light the scene"
NO_DEPTH = (
    "it measures no depth at all; uncover both of its depth sensors, and leave the least distance "
    "of its data sheet before it"
)


class PictureCheck:
    """Looks at the pictures of one camera.

    Attributes
    ----------
    note : str or None
        What is wrong with the pictures just now, and what to do.
    """

    def __init__(self) -> None:
        self.note: str | None = None
        self._last: tuple[bytes, bytes] | None = None
        self._since: dict[str, float] = {}  # by what is wrong [s]

    def is_new(self, frame: RgbdFrame) -> bool:
        """Whether a picture differs from the last: noise alone makes any two differ."""
        depth = b"" if frame.depth is None else frame.depth[::STRIDE, ::STRIDE].tobytes()
        content = frame.colour[::STRIDE, ::STRIDE].tobytes(), depth
        new, self._last = content != self._last, content
        return new

    def update(self, frame: RgbdFrame) -> None:
        """Add a picture, and renew the note."""
        wrong = []
        if is_black(frame.colour):
            wrong.append(f"its pictures are black; {OPEN_SHUTTER}")
        elif frame.depth is not None and (frame.depth[::STRIDE, ::STRIDE] > 0).mean() < MIN_DEPTH:
            wrong.append(NO_DEPTH)
        self._since = {what: self._since.get(what, frame.t) for what in wrong}
        self.note = next((w for w, t in self._since.items() if frame.t - t >= DELAY), None)


def is_black(colour: NDArray[np.uint8]) -> bool:
    """Whether a picture, (h, w, 3), shows nothing."""
    return bool((colour[::STRIDE, ::STRIDE].max(axis=2) > BLACK).mean() < MIN_LIT)
