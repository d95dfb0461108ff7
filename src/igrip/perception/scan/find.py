"""The thing to be scanned, in a frame: what stands alone on the table, and no hand on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from igrip.perception.registration.plane import Plane
from igrip.perception.registration.view import DepthView, depth_view
from igrip.perception.shapes.segments import Segment, find_segments
from igrip.rgbd import Array, RgbdFrame

APART = 0.03  # pieces nearer to one another are of one thing [m]
MIN_SHARE = 0.1  # of the points of the largest thing; less is no thing but noise; guess
NO_TABLE = "no table is seen: point the camera down at a table that fills much of the picture"
NOTHING = "nothing stands on the table: put the thing in the middle of the picture"
CUT = "it goes beyond the edge of the picture: move it to the middle, or the camera back"


@dataclass(frozen=True, eq=False)
class Sighting:
    """What was seen of the thing in one frame."""

    points: Array  # (n, 3), frame of the table, some of those on it [m]
    pixels: NDArray[np.int64]  # (n, 2), u and v
    view: DepthView

    @property
    def box(self) -> tuple[slice, slice]:
        """Rows and columns of the picture that it takes."""
        low, high = self.pixels.min(axis=0), self.pixels.max(axis=0) + 1
        return slice(int(low[1]), int(high[1])), slice(int(low[0]), int(high[0]))


@dataclass(frozen=True)
class Unseen:
    """Why the thing is not seen, or not alone."""

    problem: str | None  # and what to do; None: a hand is at it, as it has to be now and then


def find_thing(
    frame: RgbdFrame, plane: Plane, hands: Sequence[Array], reach: tuple[float, float],
    stand: float, tolerance: float,
) -> Sighting | Unseen:  # fmt: skip
    """Find the only thing on the table.

    Parameters
    ----------
    frame : RgbdFrame
        With depth.
    plane : Plane
        The table.
    hands : sequence of (n, 2)
        Where hands are in the picture [pixels].
    reach : 2 floats
        Depths that are looked at [m].
    stand : float
        Height of what it stands on over the table [m]; the frame of the table is raised by it.
    tolerance : float
        By which the camera errs, besides noise [m].
    """
    raised = plane.table_from_camera.copy()
    raised[2, 3] -= stand
    view = depth_view(frame, hands, plane._replace(table_from_camera=raised), tolerance)
    things = _things(find_segments(view.depth, view, reach, ()))
    free = [thing for thing in things if not any(piece.touched for piece in thing)]
    if not free:
        return Unseen(None if things else NOTHING)
    if len(things) > len(free):
        most = max(len(piece.points) for thing in things for piece in thing if piece.touched)
        if most > 2 * max(sum(len(piece.points) for piece in thing) for thing in free):
            return Unseen(None)  # what is left beside an arm is not the thing
    if len(free) > 1:
        return Unseen(f"{len(free)} things stand on the table: leave only the one to be scanned")
    if any(piece.cut for piece in free[0]):
        return Unseen(CUT)
    points = np.concatenate([piece.points for piece in free[0]])
    pixels = np.concatenate([piece.pixels for piece in free[0]])
    return Sighting(points, pixels, view)


def _things(segments: Sequence[Segment]) -> list[list[Segment]]:
    """Return the segments of each thing: those that touch on the table, or are near."""
    things: list[list[Segment]] = []
    for segment in sorted(segments, key=lambda one: -len(one.points)):
        near = [thing for thing in things if any(_is_near(segment, piece) for piece in thing)]
        joined = [segment, *(piece for thing in near for piece in thing)]
        things = [thing for thing in things if not any(thing is one for one in near)] + [joined]
    sizes = [sum(len(piece.points) for piece in thing) for thing in things]
    return [
        thing for thing, size in zip(things, sizes, strict=True) if size >= MIN_SHARE * max(sizes)
    ]


def _is_near(one: Segment, other: Segment) -> bool:
    if one.cluster == other.cluster:
        return True
    away, _ = cKDTree(other.points).query(one.points, distance_upper_bound=APART)
    return bool(np.min(away) < APART)
