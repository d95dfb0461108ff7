"""What can be told of a camera from its pictures: black, without depth, or always the same."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.rgbd import RgbdFrame

STRIDE = 8  # pixels between those that are looked at
BLACK = 20  # of 255; 16 is black in video levels, and a covered sensor has a little noise; guess
LIT_SHARE = 0.002  # with a lesser share of pixels over BLACK a picture is black; guess
DEPTH_SHARE = 0.005  # with a lesser share of pixels with depth there is none; guess
DELAY = 1.5  # s for which pictures must be so before it is mentioned: exposures settle; guess


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
        self._black_since: float | None = None
        self._no_depth_since: float | None = None

    def is_new(self, frame: RgbdFrame) -> bool:
        """Whether a picture differs from the last: noise alone makes any two differ."""
        depth = b"" if frame.depth is None else frame.depth[::STRIDE, ::STRIDE].tobytes()
        content = frame.colour[::STRIDE, ::STRIDE].tobytes(), depth
        new, self._last = content != self._last, content
        return new

    def update(self, frame: RgbdFrame) -> None:
        """Add a picture, and renew the note."""
        black = is_black(frame.colour)
        no_depth = frame.depth is not None and not has_depth(frame.depth)
        self._black_since = _since(self._black_since, black, frame.t)
        self._no_depth_since = _since(self._no_depth_since, no_depth, frame.t)
        self.note = None
        if _lasts(self._black_since, frame.t):
            self.note = f"its pictures are black; {OPEN_SHUTTER}"
        elif _lasts(self._no_depth_since, frame.t):
            self.note = (
                "it measures no depth at all; uncover both of its depth sensors, and leave the "
                "least distance of its data sheet before it"
            )


OPEN_SHUTTER = "open its shutter, uncover the lens, and light the scene"


def is_black(colour: NDArray[np.uint8]) -> bool:
    """Whether a picture, (h, w, 3), shows nothing."""
    return bool((colour[::STRIDE, ::STRIDE].max(axis=2) > BLACK).mean() < LIT_SHARE)


def has_depth(depth: NDArray[np.float32]) -> bool:
    """Whether a depth picture, (h, w) [m], has any measurements to speak of."""
    return bool((depth[::STRIDE, ::STRIDE] > 0.0).mean() >= DEPTH_SHARE)


def _since(since: float | None, now_so: bool, t: float) -> float | None:
    if not now_so:
        return None
    return t if since is None else since


def _lasts(since: float | None, t: float) -> bool:
    return since is not None and t - since >= DELAY
