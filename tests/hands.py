"""Pictures with hands for the tests of perception."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.errors import IgripError
from igrip.rgbd import Intrinsics, RgbdFrame

CAMERA = Intrinsics(640, 480, 450.0, 450.0, 320.0, 240.0)


def hand_detector_or_skip(**config):
    """Return a hand detector; the test is skipped where there is neither cache nor network."""
    from igrip.perception.hands.mediapipe import MediaPipeConfig, MediaPipeHands

    try:
        return MediaPipeHands(MediaPipeConfig(**config))
    except IgripError as error:
        pytest.skip(f"no hand detector: {error}")


def desk(seed=0, camera=CAMERA, depth=1.1):
    """Return a frame of a desk before a wall: plain, with a little noise."""
    rng = np.random.default_rng(seed)
    picture = np.full((camera.height, camera.width, 3), (190, 180, 165), np.float64)
    picture[: camera.height // 3] = (120, 125, 130)
    picture += rng.normal(0.0, 4.0, picture.shape)
    far = np.full((camera.height, camera.width), depth, np.float32)
    return RgbdFrame(0.0, np.clip(picture, 0, 255).astype(np.uint8), far, camera)
