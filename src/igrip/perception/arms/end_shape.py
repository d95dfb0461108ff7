"""The shape of an arm's end, as numbers that a network reads: how broad and high it is where."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_closing, binary_fill_holes, distance_transform_edt

from igrip.rgbd import Array

SQUARE = np.ones((3, 3), dtype=np.bool_)
CELL = 0.004  # of the grid that the end of an arm is drawn on [m]
LENGTH = 0.24  # of the end that is looked at: fingers, palm and wrist [m]
SECTION = 0.012  # of that length [m]
SECTIONS = round(LENGTH / SECTION)
MIN_POINTS = 25
INPUTS = 4 * SECTIONS + 3


class EndShape(NamedTuple):
    """The end of an arm, in the frame of the table [m].

    Attributes
    ----------
    tip : (3,)
        What is farthest from where the arm comes in.
    frame : (3, 3)
        Unit vectors as rows: back along the arm, across it, and towards the camera.
    inputs : (83,)
        In that frame, for each 12 mm from the tip on: half the breadth, the ends across, and the
        height of the surface [m]; then the direction to the camera.
    """

    tip: Array
    frame: Array
    inputs: Array


def end_shape(points: Array, entry: Array, camera: Array) -> EndShape | None:
    """Return the shape of an arm's end; None if too little of it is measured.

    Parameters
    ----------
    points : (n, 3)
        Of the arm's surface.
    entry, camera : (3,)
        Where the arm comes in, and where the camera is.
    """
    away = np.linalg.norm(points - entry, axis=1)
    count = max(3, len(away) // 200)
    farthest = np.argpartition(away, -count)[-count:]
    tip = np.median(points[farthest], axis=0)
    end = points[np.linalg.norm(points - tip, axis=1) < LENGTH]
    if len(end) < MIN_POINTS:
        return None
    frame = _frame(end, tip, entry, camera)
    local = (points - tip) @ frame.T
    local = local[(local[:, 0] < LENGTH) & (np.abs(local[:, 1:]) < 0.5 * LENGTH).all(axis=1)]
    if len(local) < MIN_POINTS:
        return None
    to_camera = frame @ (camera - tip)
    to_camera /= np.linalg.norm(to_camera)
    return EndShape(tip, frame, np.concatenate([*_profile(local), to_camera]))


def _frame(end: Array, tip: Array, entry: Array, camera: Array) -> Array:
    """Return unit vectors as rows: back along the arm, across it, towards the camera."""
    middle = end.mean(axis=0)
    back = middle - tip
    if np.linalg.norm(back) < 1e-3:
        back = entry - tip
    back /= max(float(np.linalg.norm(back)), 1e-9)
    rest = end - middle
    rest = rest - np.outer(rest @ back, back)
    across = np.linalg.svd(rest.T @ rest)[0][:, 0]
    across -= (across @ back) * back
    across /= max(float(np.linalg.norm(across)), 1e-9)
    up = np.cross(back, across)
    if up @ (camera - middle) < 0.0:
        across, up = -across, -up
    return np.stack([back, across, up])


def _profile(local: Array) -> list[Array]:
    """Return half-breadth, both ends across, and height of each section [m]."""
    section = np.clip((local[:, 0] / SECTION).astype(int), 0, SECTIONS - 1)
    columns = np.full((4, SECTIONS), np.nan)
    breadth = _half_breadths(local[:, :2])
    for k in range(SECTIONS):
        own = local[section == k]
        if len(own) >= 3:
            columns[1:3, k] = np.percentile(own[:, 1], [4.0, 96.0])
            columns[3, k] = np.median(own[:, 2])
            columns[0, k] = breadth[k]
    known = ~np.isnan(columns[0])
    places = np.arange(SECTIONS)
    return [np.interp(places, places[known], column[known]) for column in columns]


def _half_breadths(places: Array) -> Array:
    """Return the largest distance from the outline in each section, (20,) [m].

    ``places`` (n, 2) are along and across the arm. Gaps between rods or fingers count as filled.
    """
    # the outermost point lies in the middle of its cell: rounding must not move it to the next
    low = np.array([0.0, places[:, 1].min() - 0.5 * CELL]) - 3 * CELL
    cells = np.floor((places - low) / CELL).astype(int)
    cells = cells[cells[:, 0] >= 0]
    rows = round(LENGTH / CELL) + 3
    grid = np.zeros((rows, cells[:, 1].max() + 4), dtype=np.bool_)
    grid[np.minimum(cells[:, 0], rows - 1), cells[:, 1]] = True
    # the arm goes on where it is cut off
    grid = np.pad(grid, ((0, 20), (0, 0)), mode="edge")
    grid = binary_fill_holes(binary_closing(grid, SQUARE, iterations=3))
    breadth = CELL * distance_transform_edt(grid)[3:rows].max(axis=1)
    own: Array = breadth.reshape(SECTIONS, -1).max(axis=1)
    return own
