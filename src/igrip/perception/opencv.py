"""OpenCV, which most of perception needs and the core does not."""

from __future__ import annotations

from typing import Any

from igrip.errors import requires_extra


def load_opencv(purpose: str) -> Any:
    """Return the module ``cv2``; ``purpose`` begins the message of the MissingExtraError."""
    with requires_extra("opencv-python-headless", "hands", purpose):
        import cv2
    return cv2
