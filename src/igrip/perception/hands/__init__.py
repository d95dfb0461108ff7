"""Hand detectors: from a picture to the landmarks of the hands in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Hand
from igrip.registry import Registry
from igrip.rgbd import RgbdFrame

PALM = (0, 5, 17)  # wrist, roots of the index and the little finger; their mean is the palm centre
LANDMARKS = 21  # of a detector that knows fingers


class HandDetection(NamedTuple):
    """One hand in a picture.

    Attributes
    ----------
    landmarks : (21, 2), or (n, 2)
        Pixels, in MediaPipe's order: 0 wrist, 5 root of the index finger, 17 of the little one. Of
        a detector that knows no fingers: the palm, and then any other number of points on the hand
        and its arm.
    score : float
        The detector's confidence, 0 to 1.
    label : str or None
        ``left`` or ``right``, the detector's guess of the handedness; never a hand's identity.
    measured : Hand or None
        Where its palm is in the world, with its uncertainty, if the detector measured that itself;
        None: it follows from the landmarks and the depths about them.
    """

    landmarks: NDArray[np.float64]
    score: float
    label: str | None = None
    measured: Hand | None = None


class HandDetector(Protocol):
    """Detects hands in pictures; may remember those of each camera from frame to frame.

    A detector may have a ``problem``, a string or None: why it finds no hands just now; and
    ``needs_depth``, true: it raises an IgripError on a frame without depth.
    """

    def detect(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands in a frame, the surest first."""
        ...

    def close(self) -> None:
        """Release the networks."""
        ...


HANDS: Registry[Callable[..., HandDetector]] = Registry(
    "hand detector", "igrip.perception.hands", "igrip.hands"
)
"""By name; a member is called with its options (a mapping; each documents its own), or with nothing
where none are given."""


def new_detector(name: str, options: Mapping[str, Any] | None = None) -> HandDetector:
    """Return a new hand detector of some name; wrong options raise an IgripError."""
    member = HANDS.get(name)
    return member(options) if options else member()


def palm_pixel(landmarks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where the palm of a detection's landmarks is in the picture, (2,) [pixels]."""
    known = len(landmarks) == LANDMARKS
    palm: NDArray[np.float64] = landmarks[list(PALM)].mean(axis=0) if known else landmarks[0]
    return palm


def palm_length(landmarks: NDArray[np.float64]) -> float:
    """Return how long the palm of (21, 2) landmarks appears: wrist to knuckles [pixels]."""
    wrist, index, little = landmarks[list(PALM)]
    # a palm seen edge on is as broad as ever in one direction at least
    return float(
        max(np.linalg.norm(0.5 * (index + little) - wrist), np.linalg.norm(index - little))
    )
