"""The table before one camera, from frame to frame."""

from __future__ import annotations

import numpy as np

from igrip.perception.registration.plane import MIN_SHARE, Plane, find_plane
from igrip.perception.registration.view import measured_points
from igrip.perception.transforms import inverse
from igrip.rgbd import Array, RgbdFrame

TABLE_OVER_FLOOR = 0.25  # m, at least; guess
LEVEL = np.cos(np.radians(8.0))  # cosine between the two
STILL_THERE = 0.4  # of the share of points it had when it was found


class Table:
    """The plane that objects stand on; looked for anew where it is no more.

    Attributes
    ----------
    plane : Plane or None
        In the newest frame.
    world_from_table : (4, 4)
        Frame of the table.
    change : (4, 4) or None
        From the former frame of the table to this one, if the newest frame brought another.
    """

    def __init__(self) -> None:
        self.plane: Plane | None = None
        self.world_from_table: Array = np.eye(4)
        self.change: Array | None = None

    def update(
        self, frame: RgbdFrame, reach: tuple[float, float], random: np.random.Generator, seen: bool
    ) -> bool:
        """Take a frame; return whether there is a table.

        Parameters
        ----------
        frame : RgbdFrame
            With depth.
        reach : 2 floats
            Depths that are looked at [m].
        random : Generator
            Chooses hypotheses.
        seen : bool
            Whether something is visible that stood on it: then something large hides the table.
        """
        assert frame.depth is not None
        self.change = None
        if self.plane is not None:
            table_from_camera = inverse(self.world_from_table) @ frame.world_from_camera
            self.plane = self.plane._replace(table_from_camera=table_from_camera)
            points, _ = measured_points(frame.depth, frame.intrinsics, 16, reach)
            if is_still_there(self.plane, points):
                return True
            if seen:
                return True
        points, _ = measured_points(frame.depth, frame.intrinsics, 4, reach)
        plane = find_table(points, random)
        if plane is None:
            return self.plane is not None
        before = inverse(self.world_from_table)
        self.plane = plane
        self.world_from_table = frame.world_from_camera @ inverse(plane.table_from_camera)
        self.change = inverse(self.world_from_table) @ inverse(before)
        return True


def is_still_there(plane: Plane, points: Array) -> bool:
    """Whether a plane still holds points (n, 3) of the camera's frame [m]; not without points."""
    heights = points @ plane.table_from_camera[2, :3] + plane.table_from_camera[2, 3]
    near = np.maximum(0.01, 4.0 * plane.noise * points[:, 2] ** 2)
    return len(points) > 0 and bool((np.abs(heights) < near).mean() > STILL_THERE * plane.share)


def find_table(points: Array, random: np.random.Generator) -> Plane | None:
    """Return the largest plane of points (n, 3), or a level one over it: the table, not the floor.

    The points are in the camera's frame [m].
    """
    plane = find_plane(points, random)
    if plane is None:
        return None
    heights = points @ plane.table_from_camera[2, :3] + plane.table_from_camera[2, 3]
    above = points[heights > TABLE_OVER_FLOOR]
    upper = find_plane(above, random)
    if upper is None:
        return plane
    level = plane.table_from_camera[2, :3] @ upper.table_from_camera[2, :3] > LEVEL
    share = upper.share * len(above) / len(points)
    return upper._replace(share=share) if level and share > MIN_SHARE else plane
