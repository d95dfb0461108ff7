"""What is in front of the background and over the table, in pieces that hang together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, grey_dilation, label
from scipy.spatial import cKDTree

from igrip.perception.arms.background import Background, Changes, Depths, Mask, solid
from igrip.perception.arms.table import Table
from igrip.rgbd import Array

MIN_HEIGHT, MAX_HEIGHT = 0.012, 0.65  # of an arm above the table [m]; guess
EDGE = 0.03  # what ends so near the table's edge comes in over it [m]; guess
JUMP = 0.04  # a step in depth that parts two surfaces [m]; guess
MIN_PIXELS = 12
GAP = 0.04  # pieces so near to each other in space are one [m]; guess
CONTACT = 6  # pixels of a still piece that touch what has moved, and what it uncovered; guess
SQUARE = np.ones((3, 3), dtype=np.bool_)


class Scene(NamedTuple):
    """One frame over its table, at the size that arms are looked for in."""

    depth: Depths  # (h, w) along the optical axis [m]; 0: not measured
    points: Array  # (h, w, 3), in the frame of the table [m]
    tolerance: Depths  # (h, w): what differs by more is something else [m]
    above: Mask  # (h, w): over the table
    beyond: Array  # (h, w): how far beyond the table's edge [m]; set where something is above


class Blob(NamedTuple):
    """One piece that is no background.

    Attributes
    ----------
    pixels : (n, 2)
        Rows and columns that are measured.
    points : (n, 3)
        Theirs, in the frame of the table [m].
    entry : (3,) or None
        Where it comes in over the edge of the table or of the picture [m].
    appeared : bool
        It is where the background was known: it was not always there.
    """

    pixels: NDArray[np.int64]
    points: Array
    entry: Array | None
    appeared: bool


def scene_of(depth: Depths, points: Array, table: Table) -> Scene:
    """Return a frame over its table; ``points`` (h, w, 3) are in the frame of the camera [m]."""
    pose = table.plane.table_from_camera
    placed = points @ pose[:3, :3].T + pose[:3, 3]
    std = table.plane.noise * points[..., 2] ** 2
    low = np.maximum(MIN_HEIGHT, 3.0 * std)
    height = placed[..., 2]
    above = (depth > 0.0) & (height > low) & (height < MAX_HEIGHT)
    beyond = np.full(depth.shape, np.inf)
    beyond[above] = table.beyond(placed[above])
    above &= beyond < EDGE
    tolerance = np.maximum(0.012, 0.008 + 3.0 * std).astype(np.float32)
    return Scene(depth, placed, tolerance, above, beyond)


def find_blobs(scene: Scene, changes: Changes, background: Background) -> list[Blob]:
    """Return the pieces that are in front of the background, the largest first.

    What is still and touches something that moves, where something was uncovered as well, moves
    along: a resting arm that sets out was background, and is so no longer.
    """
    moved = scene.above & solid(changes.nearer)
    still = scene.above & ~changes.nearer
    setting_out = _set_out(still, moved & changes.known, changes.disclosed)
    if setting_out.any():
        background.forget(setting_out)
        moved |= setting_out
    # cloth without depth hangs together with what is measured
    bridged = (moved & ~_steps(scene.depth, moved)) | changes.lost
    numbers, count = label(bridged, SQUARE)
    for _ in range(2):  # the pixels of a step go with what is beside them
        grown = grey_dilation(numbers, size=(3, 3))
        numbers = np.where((numbers == 0) & moved, grown, numbers)
    sizes = np.bincount(numbers[moved], minlength=count + 1)
    blobs = [
        blob
        for number in range(1, count + 1)
        if sizes[number] >= MIN_PIXELS
        and (blob := _blob(scene, changes, numbers == number, moved)) is not None
    ]
    return sorted(_gathered(blobs), key=lambda blob: -len(blob.points))


def _gathered(blobs: list[Blob]) -> list[Blob]:
    """Join the pieces that are close in space: rods, fingers and straps hide what links them."""
    joined: list[list[Blob]] = []
    for blob in blobs:
        near = [others for others in joined if any(_close(blob, other) for other in others)]
        apart = [others for others in joined if not any(others is one for one in near)]
        joined = [*apart, [blob, *(other for others in near for other in others)]]
    return [join(others) for others in joined]


def _close(one: Blob, other: Blob) -> bool:
    if not (one.appeared and other.appeared):  # what was there from the beginning may be things
        return False
    if (_box(one)[0] > _box(other)[1] + GAP).any() or (_box(other)[0] > _box(one)[1] + GAP).any():
        return False
    gaps, _ = cKDTree(one.points[::2]).query(other.points[::2], distance_upper_bound=GAP)
    return bool(np.min(gaps) < GAP)


def _box(blob: Blob) -> tuple[Array, Array]:
    return blob.points.min(axis=0), blob.points.max(axis=0)


def join(blobs: list[Blob]) -> Blob:
    """Return several pieces as one."""
    if len(blobs) == 1:
        return blobs[0]
    entries = [blob for blob in blobs if blob.entry is not None]
    main = max(entries, key=lambda blob: len(blob.points), default=blobs[0])
    return Blob(
        np.concatenate([blob.pixels for blob in blobs]),
        np.concatenate([blob.points for blob in blobs]),
        main.entry, any(blob.appeared for blob in blobs),
    )  # fmt: skip


def _set_out(still: Mask, moved: Mask, disclosed: Mask) -> Mask:
    """Return the still pieces that begin to move, (h, w)."""
    numbers, count = label(still, SQUARE)
    if not count:
        return np.zeros_like(still)
    by_moved = np.bincount(numbers[binary_dilation(moved, SQUARE)], minlength=count + 1)
    by_left = np.bincount(
        numbers[binary_dilation(disclosed, SQUARE, iterations=2)], minlength=count + 1
    )
    size = np.bincount(numbers.ravel(), minlength=count + 1)
    moves = (by_moved >= CONTACT) & (by_left >= CONTACT) & (size >= MIN_PIXELS)
    moves[0] = False
    result: Mask = moves[numbers]
    return result


def _steps(depth: Depths, mask: Mask) -> Mask:
    """Return the pixels of a mask on the farther side of a step in depth, (h, w)."""
    steps = np.zeros_like(mask)
    for axis in (0, 1):
        ahead = np.diff(depth, axis=axis)
        one, other = [slice(None)] * 2, [slice(None)] * 2
        one[axis], other[axis] = slice(None, -1), slice(1, None)
        both = mask[tuple(one)] & mask[tuple(other)]
        steps[tuple(other)] |= both & (ahead > JUMP)
        steps[tuple(one)] |= both & (ahead < -JUMP)
    return steps


def _blob(scene: Scene, changes: Changes, own: Mask, moved: Mask) -> Blob | None:
    measured = own & moved
    pixels = np.argwhere(measured)
    points = scene.points[measured]
    entry = _entry(scene, own, measured, pixels, points)
    return Blob(pixels, points, entry, bool(changes.known[measured].mean() > 0.5))


def _entry(
    scene: Scene, own: Mask, measured: Mask, pixels: NDArray[np.int64], points: Array
) -> Array | None:
    """Return where a piece comes in, or None if it touches no edge."""
    over = points[scene.beyond[measured] > -EDGE]
    if len(over) >= 8:
        middle: Array = np.median(over, axis=0)
        return middle
    rows, columns = np.nonzero(own)
    height, width = own.shape
    border = (rows < 2) | (columns < 2) | (rows >= height - 2) | (columns >= width - 2)
    if border.sum() < 4:
        return None
    # where nothing is measured at the border: the nearest that is
    middle_pixel = np.array([rows[border].mean(), columns[border].mean()])
    gaps = np.linalg.norm(pixels - middle_pixel, axis=1)
    nearest = np.argsort(gaps)[: max(8, len(gaps) // 100)]
    inner: Array = np.median(points[nearest], axis=0)
    return inner
