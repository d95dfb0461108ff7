"""Views fused into one body: signed distances along the lines of sight, averaged on a grid.

Curless & Levoy 1996, SIGGRAPH: 303-312. What no view has seen through and none has seen is taken
to be solid, so that the surface is closed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, label, maximum_filter, minimum_filter, uniform_filter

from igrip.errors import requires_extra
from igrip.perception.registration.view import DepthView
from igrip.perception.scan.scan_view import ScanView
from igrip.rgbd import Array

MARGIN = 0.008  # of the grid round the thing [m]
MAX_CELLS = 60  # along the longest edge of the grid
TRUNCATED = 2.5  # cells from the surface; farther distances say no more
FREE_WEIGHT = 0.5  # of a view that sees through a place, against one that sees a surface there
BASE = 0.004  # over the table; what is lower is as it is there [m]
SMOOTH = 0.6  # cells


@dataclass(frozen=True, eq=False)
class Body:
    """Distances from a surface on a grid, negative inside, in the frame of the object."""

    values: Array  # (nx, ny, nz), in cells, at most TRUNCATED
    origin: Array  # (3,), of the first [m]
    cell: float  # [m]


def fused(views: Sequence[ScanView], cell: float) -> Body:
    """Return the body that views show; its grid's cells have edges of ``cell`` [m] or more.

    Large things get larger cells: a mesh of more triangles is slower, not better.
    """
    points = np.concatenate([view.in_object[0] for view in views])
    low, high = points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
    low[2] = 0.0
    cell = max(cell, float((high - low).max()) / MAX_CELLS)
    # the table is half way between the first two layers
    origin = np.array([low[0], low[1], -0.5 * cell])
    shape = tuple(int(n) for n in np.ceil((high - origin) / cell) + 1)
    axes = [origin[k] + cell * np.arange(shape[k]) for k in range(3)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    sums, weights = np.zeros(len(places)), np.zeros(len(places))
    for view in views:
        _add(view, places, TRUNCATED * cell, sums, weights)
    values = np.where(weights > 0.0, sums / np.maximum(weights, 1e-9), -1.0).reshape(shape)
    return Body(_closed(TRUNCATED * values, cell), origin, cell)


def _add(view: ScanView, places: Array, reach: float, sums: Array, weights: Array) -> None:
    """Add one view's distances, in shares of ``reach`` [m], to those at places (n, 3)."""
    sight = view.sighting.view
    depth, cosine, edge = _surface(sight)
    table = view.pose.to_table(places)
    camera = table @ sight.camera_from_table[:3, :3].T + sight.camera_from_table[:3, 3]
    pixels = np.round(sight.intrinsics.pixels(camera)).astype(np.int64)
    height, width = depth.shape
    inside = np.flatnonzero(((pixels >= 0) & (pixels < (width, height))).all(axis=1))
    u, v = pixels[inside].T
    measured = depth[v, u]
    inside, u, v = inside[measured > 0.0], u[measured > 0.0], v[measured > 0.0]
    z = camera[inside, 2]
    ray = np.linalg.norm(camera[inside], axis=1) / z
    distance = (depth[v, u] - z) * ray * cosine[v, u] / reach
    # behind the surface a view says less and less, so that thin walls have two sides
    weight = np.clip((1.0 + distance) / 0.7, 0.0, 1.0) * cosine[v, u]
    weight[distance > 1.0] = FREE_WEIGHT
    weight[edge[v, u] & (distance < 1.0)] = 0.0
    sums[inside] += weight * np.clip(distance, -1.0, 1.0)
    weights[inside] += weight


def _surface(view: DepthView) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return depth (h, w) [m], cosines of surface and line of sight, and where an edge is."""
    depth = view.depth.astype(np.float64)
    known = depth > 0.0
    some = np.where(known, depth, np.inf)
    jump = 0.012 + 4.0 * view.noise * depth**2
    near = minimum_filter(some, 3)
    far = maximum_filter(np.where(known, depth, 0.0), 3)
    edge = ~known | (far - near > jump)
    share = np.maximum(uniform_filter(known.astype(np.float64), 5), 0.04)
    smooth = uniform_filter(depth, 5) / share
    v, u = np.indices(depth.shape)
    pixels = np.stack([u.ravel(), v.ravel()], axis=1).astype(np.float64)
    points = view.intrinsics.points(pixels, smooth.ravel()).reshape(*depth.shape, 3)
    normals = np.cross(np.gradient(points, axis=1), np.gradient(points, axis=0))
    length = np.linalg.norm(normals, axis=2) * np.linalg.norm(points, axis=2)
    cosine = np.abs((normals * points).sum(axis=2)) / np.maximum(length, 1e-12)
    return depth, np.clip(cosine, 0.2, 1.0), edge


def _closed(values: Array, cell: float) -> Array:
    """Return distances of one closed body on the table."""
    values = values.copy()
    base = min(values.shape[2] - 1, round(BASE / cell) + 1)
    values[:, :, :base] = values[:, :, base : base + 1]  # the table is seen there, too
    values = gaussian_filter(values, SMOOTH)
    values[:, :, 0] = np.abs(values[:, :, 1])
    for face in (values[0], values[-1], values[:, 0], values[:, -1], values[:, :, -1]):
        np.copyto(face, np.maximum(face, 0.5))
    pieces, count = label(values < 0.0)
    if count > 1:
        largest = 1 + int(np.argmax(np.bincount(pieces.ravel())[1:]))
        values[(pieces != largest) & (pieces > 0)] = TRUNCATED
    spaces, _ = label(values >= 0.0)
    hollow = (spaces > 0) & (spaces != spaces[0, 0, -1])
    values[hollow] = -TRUNCATED
    return values


def surface_of(body: Body) -> trimesh.Trimesh:
    """Return the surface of a body, closed, its normals outward, in the frame of the object [m].

    Marching cubes (Lewiner et al. 2003), as of scikit-image.
    """
    with requires_extra("skimage", "poses", "igrip scan"):
        from skimage.measure import marching_cubes
    # triangles without an area are kept: without them the mesh would have gaps
    vertices, faces, _, _ = marching_cubes(body.values, 0.0, allow_degenerate=True)
    return trimesh.Trimesh(
        body.origin + body.cell * vertices.astype(np.float64), faces, process=False
    )
