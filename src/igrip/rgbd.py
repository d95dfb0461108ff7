"""A frame of a camera: colour, depth if it has any, and the intrinsics of both."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Intrinsics(NamedTuple):
    """A pinhole camera; its frame has x to the right, y down and z ahead.

    Pixel centres have whole coordinates.

    An argument of functions with ``@kernel``: the cache of compiled code notices an edit here.

    Attributes
    ----------
    width, height : int
        Size of the picture [pixels].
    fx, fy, cx, cy : float
        Focal lengths and principal point [pixels].
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @property
    def matrix(self) -> Array:
        """The camera matrix, shape (3, 3)."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def scaled(self, width: int, height: int) -> Intrinsics:
        """Return the intrinsics of the same picture at another size."""
        a, b = width / self.width, height / self.height
        return Intrinsics(
            width, height, a * self.fx, b * self.fy,
            a * (self.cx + 0.5) - 0.5, b * (self.cy + 0.5) - 0.5,
        )  # fmt: skip

    def points(self, pixels: Array, depth: Array) -> Array:
        """Return points in the camera's frame [m] from pixels (n, 2) and their depths (n,) [m]."""
        x = (pixels[:, 0] - self.cx) * depth / self.fx
        y = (pixels[:, 1] - self.cy) * depth / self.fy
        return np.stack([x, y, depth], axis=1)

    def pixels(self, points: Array) -> Array:
        """Return the pixels (n, 2) of points in the camera's frame, shape (n, 3) [m]."""
        z = points[:, 2]
        return np.stack(
            [self.fx * points[:, 0] / z + self.cx, self.fy * points[:, 1] / z + self.cy], axis=1
        )


@dataclass(frozen=True, eq=False)
class RgbdFrame:
    """One frame of one camera: rectified pictures with the same intrinsics.

    Attributes
    ----------
    t : float
        Time of exposure on the host's monotonic clock [s].
    colour : (h, w, 3) uint8
        Red, green, blue.
    depth : (h, w) float32, or None
        Along the optical axis, aligned to the colour picture [m]; 0 where nothing was measured.
    intrinsics : Intrinsics
        Of both pictures.
    camera : str
        Name of the camera.
    world_from_camera : (4, 4)
        Pose of the camera; by default the world is the camera's own frame.
    """

    t: float
    colour: NDArray[np.uint8]
    depth: NDArray[np.float32] | None
    intrinsics: Intrinsics
    camera: str = "camera"
    world_from_camera: Array = field(default_factory=lambda: np.eye(4))
