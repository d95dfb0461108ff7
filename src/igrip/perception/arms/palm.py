"""The palm of an arm, from the shape of its end: the widest place a hand's length from the tip.

It asks for no fingers: a fist, a mitten, a splint or a hook end an arm as well.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import (
    binary_closing,
    binary_fill_holes,
    distance_transform_edt,
    uniform_filter1d,
)

from igrip.rgbd import Array

SQUARE = np.ones((3, 3), dtype=np.bool_)
CELL = 0.004  # of the grid that the end of an arm is drawn on [m]
HAND = 0.24  # length of the end that is looked at: fingers, palm and wrist [m]
RANGE = (0.045, 0.165)  # of the palm's centre from the tip: fist and long straight fingers [m]
USUAL = 0.112  # of the palm's centre from the tip, where the shape does not tell [m]; guess
PALM = 0.022  # what is nowhere broader than twice that shows no palm: a hook, for one [m]; guess
NECK = 0.82  # where a palm ends it is so many times as broad as it was; guess
NEAR_NECK = 0.88  # the same before a cuff; guess
WRIST = 0.72  # and a wrist, behind it, at most; a cuff is broader; guess
TAPER, TAPERED = 0.04, 0.25  # within so far [m] the rest of the way to its narrowest; guess
TO_WRIST = 0.043  # from the palm's centre to where the arm is so narrow [m]; docs/hands.md
SKIN = 0.010  # the palm lies so far behind what is seen: cloth and half a hand [m]; docs/hands.md
CUFF = 1.08  # a cuff is so many times as broad as the wrist before it, at least; guess
CUFFED, TO_CUFF = (0.07, 0.17), 0.022  # where that wrist may be, and from it to the palm [m]; guess
STD, STD_SHAPELESS = 0.020, 0.030  # of a palm by its shape, and by the tip alone [m]; docs/hands.md


class ArmEnd(NamedTuple):
    """Where an arm ends, in the frame of the table [m]."""

    palm: Array  # (3,)
    tip: Array  # (3,)
    along: Array  # (3,), unit vector from the arm to the tip
    std: float  # of the palm
    back: float  # from the tip to the palm, where its shape shows it; else what was usual


def arm_end(points: Array, entry: Array, camera: Array, usual: float = USUAL) -> ArmEnd | None:
    """Return where an arm ends; None if too little of it is measured.

    Parameters
    ----------
    points : (n, 3)
        Of the arm's surface.
    entry : (3,)
        Where it comes in.
    camera : (3,)
        Where the camera is.
    usual : float
        From the tip to the palm, where the shape of this arm does not show it [m].
    """
    away = np.linalg.norm(points - entry, axis=1)
    farthest = np.argpartition(away, -max(3, len(away) // 200))[-max(3, len(away) // 200) :]
    tip = np.median(points[farthest], axis=0)
    end = points[np.linalg.norm(points - tip, axis=1) < HAND]
    if len(end) < 25:
        return None
    frame = _frame(end, tip, entry)
    local = (points - tip) @ frame.T  # x back along the arm, y across it, z normal to both
    local = local[(local[:, 0] < HAND) & (np.abs(local[:, 1:]) < 0.5 * HAND).all(axis=1)]
    breadth, low = _half_breadth(local[:, :2])
    back, std = _palm_distance(breadth, low, usual)
    near = np.abs(local[:, 0] - back) < 0.02
    if near.sum() < 8:
        return None
    row = breadth[int(np.clip((back - low[0]) / CELL, 0, len(breadth) - 1))]
    broad = row > 0.85 * row.max()
    across = float(np.mean(np.flatnonzero(broad)) * CELL + low[1]) if row.max() > 0 else 0.0
    own = local[near & (np.abs(local[:, 1] - across) < 0.03)]
    if len(own) < 4:
        own = local[near]
        across = float(np.median(own[:, 1]))
    palm = tip + np.array([back, across, float(np.median(own[:, 2]))]) @ frame
    ray = (palm - camera) / np.linalg.norm(palm - camera)
    return ArmEnd(palm + SKIN * ray, tip, -frame[0], std, back)


def _frame(end: Array, tip: Array, entry: Array) -> Array:
    """Return unit axes as rows: back along the arm, across the hand, normal to both."""
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
    return np.stack([back, across, np.cross(back, across)])


def _half_breadth(places: Array) -> tuple[Array, Array]:
    """Return the distance of each cell of the end from its outline, (n, m) [m], and the corner.

    ``places`` (n, 2) are along and across the arm; so are rows and columns.
    """
    low = places.min(axis=0) - 3 * CELL
    cells = np.floor((places - low) / CELL).astype(int)
    grid = np.zeros(cells.max(axis=0) + 1, dtype=np.bool_)
    grid[cells[:, 0], cells[:, 1]] = True
    grid[-1] = grid[-3:].any(axis=0)
    # the arm goes on where it is cut off
    grid = np.pad(np.pad(grid, ((0, 20), (0, 0)), mode="edge"), ((0, 0), (0, 3)))
    grid = binary_fill_holes(binary_closing(grid, SQUARE, iterations=3))
    breadth: Array = CELL * distance_transform_edt(grid)
    return breadth[:-20], low


def _palm_distance(breadth: Array, low: Array, usual: float) -> tuple[float, float]:
    """Return how far behind the tip the palm's centre is, and its standard deviation [m].

    Fingers may be long or bent, but from the palm to the wrist it is always as far: where the arm,
    coming from the tip, first becomes narrower than it was. Where nothing does (a long cuff), the
    usual distance is.
    """
    rows = uniform_filter1d(breadth.max(axis=1), 3)
    back = low[0] + CELL * (np.arange(len(rows)) + 0.5)
    until = np.maximum.accumulate(np.where(back > 0.02, rows, 0.0))
    neck = (until >= PALM) & (rows < NECK * until) & (back >= RANGE[0]) & (back < HAND - 0.01)
    if neck.any():
        first = int(np.argmax(neck))
        behind = rows[first : first + round(TAPER / CELL)]
        if behind.min() < WRIST * until[first]:
            slim = behind.min() + TAPERED * (until[first] - behind.min())
            wrist = first + int(np.argmax(behind <= slim))
            return float(np.clip(back[wrist] - TO_WRIST, *RANGE)), STD
    inside = np.flatnonzero((back >= CUFFED[0]) & (back <= CUFFED[1]))
    if len(inside):  # a cuff or a splint begins behind a wrist that is hardly narrower
        low_rows = rows[inside] <= rows[inside].min() + 1e-3
        least = int(inside[len(inside) - 1 - np.argmax(low_rows[::-1])])
        later = rows[least : least + round(2 * TAPER / CELL)].max()
        if until[least] >= PALM and rows[least] < min(NEAR_NECK * until[least], later / CUFF):
            middle = float(back[inside][low_rows].mean())
            return float(np.clip(middle - TO_CUFF, *RANGE)), 0.5 * (STD + STD_SHAPELESS)
    return usual, STD_SHAPELESS
