"""``rendered:SEED``: a camera that is not there, over a table with the paper's four objects."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import numpy as np

from igrip.cameras.base import CAMERAS, Camera, CameraError
from igrip.objects.catalog import PAPER_OBJECTS, load_objects
from igrip.rgbd import RgbdFrame
from igrip.simulation.rendered import RenderedScene, strewn_scene

RATE = 30.0  # frames a second, at most


@CAMERAS.register("rendered")
def _rendered(rest: str) -> Camera:
    try:
        seed = int(rest or "0")
    except ValueError:
        raise CameraError(f"rendered:{rest}: write rendered or rendered:SEED, a number") from None
    if seed < 0:
        raise CameraError(f"rendered:{rest}: the seed must not be negative")
    return RenderedCamera(seed)


class RenderedCamera:
    """A still scene with new noise in each frame, as time goes by.

    Parameters
    ----------
    seed : int
        Of the scene and of the noise.
    """

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)
        self.scene: RenderedScene = strewn_scene(load_objects("ycb"), PAPER_OBJECTS, self._random)
        self._closed = threading.Event()

    def __iter__(self) -> Iterator[RgbdFrame]:
        """Yield frames until the camera is closed."""
        due = time.monotonic()
        while not self._closed.wait(max(0.0, due - time.monotonic())):
            now = time.monotonic()
            due = max(due + 1.0 / RATE, now)
            yield self.scene.frame(now, self._random)

    def close(self) -> None:
        """End the iteration."""
        self._closed.set()
