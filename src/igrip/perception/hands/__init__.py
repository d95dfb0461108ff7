"""Hand detectors: from a picture to the landmarks of the hands in it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from igrip.registry import Registry
from igrip.rgbd import RgbdFrame

PALM = (0, 5, 17)  # wrist, roots of the index and the little finger; their mean is the palm centre


class HandDetection(NamedTuple):
    """One hand in a picture.

    Attributes
    ----------
    landmarks : (21, 2)
        Pixels, in MediaPipe's order: 0 wrist, 5 root of the index finger, 17 of the little one.
    score : float
        The detector's confidence, 0 to 1.
    label : str or None
        ``left`` or ``right``, the detector's guess of the handedness; never a hand's identity.
    """

    landmarks: NDArray[np.float64]
    score: float
    label: str | None = None


class HandDetector(Protocol):
    """Detects hands in pictures; may remember those of each camera from frame to frame."""

    def detect(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands in a frame, the surest first. Reads the colour picture alone."""
        ...

    def close(self) -> None:
        """Release the networks."""
        ...


HANDS: Registry[Callable[[], HandDetector]] = Registry(
    "hand detector", "igrip.perception.hands", "igrip.hands"
)


def palm_length(landmarks: NDArray[np.float64]) -> float:
    """Return how long the palm of (21, 2) landmarks appears: wrist to knuckles [pixels]."""
    wrist, index, little = landmarks[list(PALM)]
    # a palm seen edge on is as broad as ever in one direction at least
    return float(
        max(np.linalg.norm(0.5 * (index + little) - wrist), np.linalg.norm(index - little))
    )
