"""The table as arms are looked for over it: its plane, and how far it is seen to extend."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, label
from scipy.spatial import ConvexHull, QhullError

from igrip.perception.registration.plane import Plane
from igrip.perception.registration.table import find_table, is_still_there
from igrip.perception.transforms import inverse
from igrip.rgbd import Array, RgbdFrame

CELL = 0.02  # of the grid that locates the table [m]
HALF = 150  # cells from the camera's foot to the end of that grid
MIN_AREA = 0.06  # m²; a smaller plane is no table to reach over; guess
DISTANCE = (0.15, 1.8)  # of the camera from the plane [m]; farther is a floor or a wall; guess
MIN_UP = np.cos(np.radians(30.0))  # of the plane's normal, where the camera's place is known
OFTEN = 4  # pixels on a cell of the table, so that it is one


class NoTableError(Exception):
    """There is no table in the picture; the message says what there is instead."""


class Table:
    """The table before one camera.

    ``plane`` is that of the table; ``outline`` holds the outward normals and offsets of its edges,
    (n, 3), in the frame of the table [m].
    """

    def __init__(self, points: Array, frame: RgbdFrame, random: np.random.Generator) -> None:
        plane = None if len(points) < 100 else find_table(points, random)
        if plane is None:
            raise NoTableError("no plane is large enough to be one")
        _check(plane, frame)
        self.plane = plane
        self._world_from_table = frame.world_from_camera @ inverse(plane.table_from_camera)
        self._counts = np.zeros((2 * HALF, 2 * HALF), dtype=np.int32)
        self.outline = np.empty((0, 3))
        self.centre = np.zeros(2)
        self.extend(points)

    def is_where_it_was(self, points: Array, frame: RgbdFrame) -> bool:
        """Whether the plane still holds points, (n, 3) in the frame of the camera."""
        return self.is_seen_from(frame) and is_still_there(self.plane, points)

    def is_seen_from(self, frame: RgbdFrame) -> bool:
        """Whether a camera stands where it stood."""
        now = inverse(self._world_from_table) @ frame.world_from_camera
        return bool(np.allclose(now, self.plane.table_from_camera, atol=1e-6))

    def extend(self, points: Array) -> None:
        """Add points on the table, among (n, 3) in the frame of the camera, to its outline."""
        pose = self.plane.table_from_camera
        table = points @ pose[:3, :3].T + pose[:3, 3]
        near = np.maximum(0.008, 2.5 * self.plane.noise * points[:, 2] ** 2)
        on = np.abs(table[:, 2]) < near
        cells = np.floor(table[on, :2] / CELL).astype(np.int64) + HALF
        cells = cells[((cells >= 0) & (cells < 2 * HALF)).all(axis=1)]
        np.add.at(self._counts, (cells[:, 0], cells[:, 1]), 1)
        held = binary_closing(np.pad(self._counts >= OFTEN, 3), iterations=2)[3:-3, 3:-3]
        pieces, count = label(held)
        sizes = np.bincount(pieces.ravel(), minlength=count + 1)
        sizes[0] = 0
        if sizes.max() * CELL**2 < MIN_AREA:
            raise NoTableError("the largest plane is a small one")
        places = (np.argwhere(pieces == int(np.argmax(sizes))) + 0.5 - HALF) * CELL
        try:
            self.outline = ConvexHull(places).equations
        except QhullError:
            raise NoTableError("the largest plane is a narrow strip") from None
        self.centre = places.mean(axis=0)

    def beyond(self, points: Array) -> Array:
        """Return how far points (n, 2 or 3) of the table's frame lie beyond its edge [m].

        Negative over the table.
        """
        away = np.full(len(points), -np.inf)
        for a, b, c in self.outline.tolist():
            np.maximum(away, a * points[:, 0] + b * points[:, 1] + c, out=away)
        return away


def _check(plane: Plane, frame: RgbdFrame) -> None:
    """Refuse a plane that cannot be a table's."""
    away = float(plane.table_from_camera[2, 3])
    if not DISTANCE[0] <= away <= DISTANCE[1]:
        raise NoTableError(f"the largest plane is {away:.1f} m from the camera, a floor or a wall")
    pose: NDArray[np.float64] = frame.world_from_camera
    if not np.array_equal(pose, np.eye(4)):
        up = pose[2, :3] @ plane.table_from_camera[2, :3]
        if up < MIN_UP:
            raise NoTableError("the largest plane is not level")
