"""The mesh of a thing: the simple shape, cut where it is seen through, and grown where points are.

What is hidden is completed by the symmetry of the simple shape. The surface is described by its
distance from the vertical through the middle of the thing, at some heights and angles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.perception.registration.view import DepthView
from igrip.perception.shapes.fit_primitive import ShapeFit
from igrip.rgbd import Array

LEVELS, ANGLES = 15, 48
SHARES = np.linspace(1.0, 0.15, 18)  # of a radius, at which it is looked whether it is seen through
MIN_IN_CELL = 2  # points that agree
MIN_CHANGE = 0.06  # of the volume; a lesser change is noise, and the simple shape is the mesh
MIN_LARGER = 0.04  # of an edge of the bounding box, likewise


class Surface(NamedTuple):
    """A mesh in the frame of its thing, and whether it still is the simple shape."""

    mesh: trimesh.Trimesh
    simple: bool


def surface_of(
    fit: ShapeFit, points: Array, depth: NDArray[np.float32], view: DepthView
) -> Surface:
    """Return the mesh of a thing; its origin is on the table under the middle of the shape [m].

    Parameters
    ----------
    fit : ShapeFit
        The simple shape.
    points : (n, 3)
        Measured on the thing, frame of the table [m].
    depth : (h, w)
        Averaged along the optical axis [m].
    view : DepthView
        Where the camera is, and its noise.
    """
    top = fit.primitive.height(fit.parameters)
    limit = view.tolerance + 2.5 * view.noise * float(np.median(depth[depth > 0.0])) ** 2
    seen_top = float(np.percentile(points[:, 2], 99.0))
    if seen_top > top + 0.5 * limit:  # a neck, a cap, a stalk
        top = seen_top
    levels = np.linspace(0.02, 0.98, LEVELS) * top
    angles = np.linspace(0.0, 2.0 * np.pi, ANGLES, endpoint=False)
    simple = fit.primitive.radii(fit.parameters, levels, angles)
    radii = _carved(simple, levels, angles, fit.parameters[:2], depth, view, limit)
    radii = _grown(radii, levels, angles, points - np.append(fit.parameters[:2], 0.0), limit)
    wall = fit.primitive.wall
    inner = None if wall is None else np.maximum(simple - wall, 0.3 * simple)
    changed = np.abs(radii**2 - simple**2).sum() / (simple**2).sum()
    plain, lofted = fit.primitive.mesh(fit.parameters), _loft(radii, inner, levels, angles, top)
    larger = float((lofted.extents / plain.extents).max()) - 1.0
    if changed < MIN_CHANGE and larger < MIN_LARGER:
        return Surface(plain, True)
    return Surface(lofted, False)


def _carved(
    radii: Array, levels: Array, angles: Array, middle: Array, depth: NDArray[np.float32],
    view: DepthView, limit: float,
) -> Array:  # fmt: skip
    """Return radii without what is seen through from outside."""
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    flat = SHARES[:, None, None, None] * radii[None, ..., None] * directions + middle
    heights = np.broadcast_to(levels[None, :, None, None], (*flat.shape[:3], 1))
    table = np.concatenate([flat, heights], axis=3).reshape(-1, 3)
    camera = table @ view.camera_from_table[:3, :3].T + view.camera_from_table[:3, 3]
    pixels = np.round(view.intrinsics.pixels(camera)).astype(np.int64)
    height, width = depth.shape
    inside = ((pixels >= 0) & (pixels < (width, height))).all(axis=1) & (camera[:, 2] > 0.05)
    pixels = np.clip(pixels, 0, (width - 1, height - 1))
    measured = depth[pixels[:, 1], pixels[:, 0]]
    free = inside & (measured > camera[:, 2] + limit) & (view.mask[pixels[:, 1], pixels[:, 0]] == 0)
    solid = ~free.reshape(len(SHARES), *radii.shape)
    first = np.where(solid.any(axis=0), solid.argmax(axis=0), len(SHARES) - 1)
    share = SHARES[first]
    beside = [np.roll(share, shift, axis=1) for shift in (-1, 0, 1)]
    return np.asarray(radii * np.median(beside, axis=0))


def _grown(radii: Array, levels: Array, angles: Array, points: Array, limit: float) -> Array:
    """Return radii that reach the points that stick out of them: handles, spouts, stalks."""
    away = np.linalg.norm(points[:, :2], axis=1)
    row = np.clip(np.round((points[:, 2] - levels[0]) / (levels[1] - levels[0])), 0, LEVELS - 1)
    turn = np.arctan2(points[:, 1], points[:, 0]) / (2.0 * np.pi) * len(angles)
    column = np.round(turn).astype(np.int64) % len(angles)
    row = row.astype(np.int64)
    out = away > radii[row, column] + limit
    grown = radii.copy()
    counts = np.zeros(radii.shape, dtype=np.int64)
    np.add.at(counts, (row[out], column[out]), 1)
    np.maximum.at(grown, (row[out], column[out]), away[out])
    return np.where(counts >= MIN_IN_CELL, grown, radii)


def _loft(
    radii: Array, inner: Array | None, levels: Array, angles: Array, top: float
) -> trimesh.Trimesh:
    """Return the closed mesh of such a surface; ``inner`` are the radii of its inside, if any."""
    rows, heights = [radii[:1], radii, radii[-1:]], [np.zeros(1), levels, np.array([top])]
    end = top
    if inner is not None:
        inner = np.minimum(inner, 0.95 * radii)
        rows += [inner[-1:], inner[:0:-1]]
        heights += [np.array([top]), levels[:0:-1]]
        end = float(levels[1])
    row, height = np.vstack(rows), np.concatenate(heights)
    ring = np.stack([
        row * np.cos(angles), row * np.sin(angles), np.repeat(height[:, None], len(angles), axis=1),
    ], axis=2)  # fmt: skip
    vertices = np.vstack([ring.reshape(-1, 3), [[0.0, 0.0, 0.0], [0.0, 0.0, end]]])
    count, n = len(height), len(angles)
    k = np.arange(n)
    after = (k + 1) % n
    faces = [np.stack([after, k, np.full(n, count * n)], axis=1)]
    for level in range(count - 1):
        a, b = level * n + k, level * n + after
        faces += [np.stack([a, b, b + n], axis=1), np.stack([a, b + n, a + n], axis=1)]
    last = (count - 1) * n
    faces.append(np.stack([last + k, last + after, np.full(n, count * n + 1)], axis=1))
    return trimesh.Trimesh(vertices, np.concatenate(faces), process=False)
