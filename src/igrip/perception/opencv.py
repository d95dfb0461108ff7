"""OpenCV, which most of perception needs and the core does not."""

from __future__ import annotations

from typing import Any

from igrip.errors import requires_extra


def load_opencv(purpose: str) -> Any:
    """Return the module ``cv2``.

    Parameters
    ----------
    purpose : str
        What needs it; begins the message of the error.

    Raises
    ------
    MissingExtraError
        If it is not installed.
    """
    with requires_extra("opencv-python-headless", "hands", purpose):
        import cv2
    return cv2
