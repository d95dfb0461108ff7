"""A depth picture averaged over the frames in which nothing moved there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.rgbd import Array, RgbdFrame

MAX_FRAMES = 24  # an average forgets older ones
TURNED = 1e-4  # another entry of the camera's pose: it has moved


class DepthAverage:
    """Running means of one camera's depth, pixel by pixel.

    Attributes
    ----------
    depth : (h, w)
        Mean along the optical axis [m]; 0: not measured.
    counts : (h, w)
        Frames in the mean.
    """

    def __init__(self) -> None:
        self.depth: NDArray[np.float32] = np.zeros((0, 0), dtype=np.float32)
        self.counts: NDArray[np.uint8] = np.zeros((0, 0), dtype=np.uint8)
        self._pose: Array = np.zeros((4, 4))

    def add(self, frame: RgbdFrame, noise: float) -> None:
        """Add a frame; ``noise`` is that of :class:`igrip.perception.registration.plane.Plane`."""
        assert frame.depth is not None
        depth = np.ascontiguousarray(frame.depth, dtype=np.float32)
        moved = np.abs(self._pose - frame.world_from_camera).max() > TURNED
        if moved or depth.shape != self.depth.shape:
            self.depth = np.zeros(depth.shape, dtype=np.float32)
            self.counts = np.zeros(depth.shape, dtype=np.uint8)
            self._pose = frame.world_from_camera.copy()
        _add(depth, self.depth, self.counts, noise, MAX_FRAMES)


@kernel
def _add(depth, mean, counts, noise, most):
    for v in range(depth.shape[0]):
        for u in range(depth.shape[1]):
            z, old = depth[v, u], mean[v, u]
            if not z > 0.0:
                # a hole is no news; one that stays is no surface
                if counts[v, u] > 0:
                    counts[v, u] -= 1
                    if counts[v, u] == 0:
                        mean[v, u] = 0.0
                continue
            if counts[v, u] > 0 and abs(z - old) < 0.008 + 5.0 * noise * z * z:
                if counts[v, u] < most:
                    counts[v, u] += 1
                mean[v, u] = old + (z - old) / counts[v, u]
            else:
                mean[v, u] = z
                counts[v, u] = 1
