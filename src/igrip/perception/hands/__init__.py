"""What a hand finder is: from a picture to the landmarks of the hands in it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from igrip.registry import Registry
from igrip.rgbd import RgbdFrame


class HandDetection(NamedTuple):
    """One hand in a picture.

    Attributes
    ----------
    landmarks : (21, 2)
        Pixels, in MediaPipe's order: 0 wrist, 5 root of the index finger, 17 of the little one.
    score : float
        The finder's confidence, 0 to 1.
    label : str or None
        ``left`` or ``right``, as the finder guesses; never a hand's identity.
    """

    landmarks: NDArray[np.float64]
    score: float
    label: str | None = None


class HandDetector(Protocol):
    """Finds hands in pictures; keeps what it likes from one to the next of the same camera."""

    def find(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands in a frame, the surest first. Reads the colour picture alone."""
        ...

    def close(self) -> None:
        """Let go of what it holds."""
        ...


HANDS: Registry[Callable[[], HandDetector]] = Registry(
    "hand detector", "igrip.perception.hands", "igrip.hands"
)
