"""A table seen straight from above, with arms and blocks as flat shapes: depth by arithmetic."""

from __future__ import annotations

import numpy as np

from igrip.rgbd import Intrinsics, RgbdFrame

CAMERA = Intrinsics(320, 240, 260.0, 260.0, 159.5, 119.5)
FAR = 1.0  # m, of the table
V, U = np.mgrid[0:240, 0:320]
PALM, FINGERS, FOREARM = 0.042, 0.10, 0.028  # half breadth, from palm to tips, half breadth [m]


class View:
    """What a camera above a table measures."""

    def __init__(self, seed=0, noise=0.002):
        self._rng = np.random.default_rng(seed)
        self._noise = noise
        self.depth = np.full(U.shape, FAR)

    def _at(self, depth):
        return np.stack([(U - CAMERA.cx) * depth / CAMERA.fx, (V - CAMERA.cy) * depth / CAMERA.fy])

    def block(self, x, y, size=0.07, height=0.12):
        """Put a block on the table, at x, y [m]."""
        place = self._at(FAR - height)
        inside = (np.abs(place[0] - x) < size / 2) & (np.abs(place[1] - y) < size / 2)
        self.depth[inside] = np.minimum(self.depth[inside], FAR - height)
        return self

    def arm(self, palm, elbow, height=0.08):
        """Put an arm with a round palm and a short slab of fingers over the table."""
        place = self._at(FAR - height)
        palm, elbow = np.array(palm, float), np.array(elbow, float)
        along = (palm - elbow) / np.linalg.norm(palm - elbow)
        ahead = (place[0] - palm[0]) * along[0] + (place[1] - palm[1]) * along[1]
        aside = np.abs((place[0] - palm[0]) * -along[1] + (place[1] - palm[1]) * along[0])
        body = (np.hypot(ahead, aside) < PALM) | (
            (ahead > 0.0) & (ahead < FINGERS) & (aside < 0.032)
        )
        back = np.linalg.norm(palm - elbow)
        body |= (ahead < 0.0) & (ahead > -back) & (aside < FOREARM)
        self.depth[body] = np.minimum(self.depth[body], FAR - height)
        return self

    def frame(self, t, camera="above"):
        """Return the frame, with noise."""
        noisy = self.depth + self._noise * self._rng.standard_normal(self.depth.shape)
        picture = np.full((*U.shape, 3), 120, np.uint8)
        return RgbdFrame(t, picture, noisy.astype(np.float32), CAMERA, camera)


def palm_point(x, y, height=0.08):
    """Return where a palm at x, y [m] is in the frame of the camera."""
    return np.array([x, y, FAR - height])
