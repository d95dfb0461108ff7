"""A mesh as a heap of triangles: its frame, centre, nearest points and ray hits by brute force."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.spatial import ConvexHull


class Mesh:
    """Triangles in the frame of their file, with what docs/decisions/0013 derives from them.

    Attributes: ``corners`` (f, 3, 3), ``points`` (v, 3) the vertices that faces use, ``middle`` of
    the axis-aligned box and ``radius`` of a ball round it, ``centre`` of gravity, ``axis`` and
    ``length`` of the cylinder, ``mid`` the position of its mid-length along the axis.
    """

    def __init__(self, vertices, faces, axis=None):
        vertices, faces = np.asarray(vertices, dtype=float), np.asarray(faces, dtype=int)
        self.vertices, self.faces = vertices, faces
        self.corners = vertices[faces]
        self.points = vertices[np.unique(faces)]
        self.middle = 0.5 * (self.points.min(axis=0) + self.points.max(axis=0))
        self.radius = float(np.linalg.norm(self.points - self.middle, axis=1).max())
        self.centre = centre_of_gravity(vertices, faces)
        if axis is None:
            axes, extents = smallest_box(self.points)
            axis = axes[np.argmax(extents)]
        self.axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
        along = self.points @ self.axis
        self.length = float(np.ptp(along))
        self.mid = 0.5 * (along.min() + along.max())

    def axial(self, point):
        """Return z in the object frame of a point in the frame of the mesh."""
        return float(point @ self.axis - self.mid)


def is_closed(faces):
    """Whether every edge has exactly one neighbour of the opposite direction."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there, counts = np.unique(edges, axis=0, return_counts=True)
    back = np.unique(edges[:, ::-1], axis=0)
    return bool((counts == 1).all() and there.shape == back.shape and (there == back).all())


def centre_of_gravity(vertices, faces):
    """Centre of the enclosed volume; of the convex hull where the mesh encloses none."""
    if is_closed(faces):
        base = vertices[faces].reshape(-1, 3).mean(axis=0)
        volumes, centres = _tetrahedra(base, vertices[faces])
        if volumes.sum() > 0.0:
            return (volumes @ centres) / volumes.sum()
    used = vertices[np.unique(faces)]
    hull = ConvexHull(used)
    volumes, centres = _tetrahedra(used[hull.vertices].mean(axis=0), used[hull.simplices])
    volumes = np.abs(volumes)
    return (volumes @ centres) / volumes.sum()


def _tetrahedra(base, corners):
    a, b, c = (corners[:, i] - base for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0, base + (a + b + c) / 4.0


def smallest_box(points):
    """Return axes (rows) and extents of the box of least volume that stands on a hull face."""
    hull = ConvexHull(points)
    corners = points[hull.vertices]
    normals = np.unique(np.round(hull.equations[:, :3], 12), axis=0)
    best_volume, best = np.inf, None
    for normal in normals:
        z = normal / np.linalg.norm(normal)
        x = np.eye(3)[np.argmin(np.abs(z))]
        x = x - (x @ z) * z
        x /= np.linalg.norm(x)
        y = np.cross(z, x)
        flat = corners @ np.stack([x, y], axis=1)
        rim = flat[ConvexHull(flat).vertices]
        along = np.roll(rim, -1, axis=0) - rim
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        width, depth = np.ptp(along @ rim.T, axis=1), np.ptp(across @ rim.T, axis=1)
        height = np.ptp(corners @ z)
        k = int(np.argmin(width * depth))
        if width[k] * depth[k] * height < best_volume * (1.0 - 1e-12):
            best_volume = width[k] * depth[k] * height
            axes = np.stack([along[k] @ [x, y], across[k] @ [x, y], z])
            best = axes, np.array([width[k], depth[k], height])
    return best


def nearest_vertex(mesh, point):
    """Distance to the nearest vertex of a face."""
    return float(np.linalg.norm(mesh.points - point, axis=1).min())


def nearest_surface(corners, point):
    """Return the distance to the nearest point of any triangle (f, 3, 3), and that point."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    candidates = []
    for start, end in itertools.pairwise((a, b, c, a)):
        edge = end - start
        size = np.einsum("ij,ij->i", edge, edge)
        part = np.einsum("ij,ij->i", point - start, edge) / np.where(size > 0.0, size, 1.0)
        candidates.append(start + np.clip(part, 0.0, 1.0)[:, None] * edge)
    normal = np.cross(b - a, c - a)
    size = np.einsum("ij,ij->i", normal, normal)
    solid = size > 0.0
    normal = normal / np.sqrt(np.where(solid, size, 1.0))[:, None]
    foot = point - np.einsum("ij,ij->i", point - a, normal)[:, None] * normal
    inside = solid.copy()
    for start, end in itertools.pairwise((a, b, c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(end - start, foot - start), normal) >= 0.0
    if inside.any():
        candidates.append(foot[inside])
    points = np.concatenate(candidates)
    away = np.linalg.norm(points - point, axis=1)
    k = int(np.argmin(away))
    return float(away[k]), points[k]


def ray_margins(corners, origin, directions):
    """Say for each ray (r, 3) from one origin how clearly it meets any triangle (f, 3, 3).

    Positive: it meets one, at least so far inside its edges (barycentric). Negative: it misses
    every one by so much. Triple products: ``det = d·(e2×e1)`` and so on, all triangles at once.
    """
    a = corners[:, 0]
    e1, e2, s = corners[:, 1] - a, corners[:, 2] - a, origin - a
    det = directions @ np.cross(e2, e1).T
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (directions @ np.cross(e2, s).T) / det
        v = (directions @ np.cross(s, e1).T) / det
        t = np.einsum("ij,ij->i", e2, np.cross(s, e1)) / det
        inside = np.minimum(np.minimum(u, v), 1.0 - u - v)
    inside[~(t >= 0.0) | (det == 0.0) | np.isnan(inside)] = -np.inf
    return inside.max(axis=1)


def cone_margins(mesh, apex, rays):
    """Return the margins of the rays of one cone; those that pass by the whole mesh get -inf."""
    towards = mesh.middle - apex
    along = np.maximum(rays @ towards, 0.0) / np.einsum("ij,ij->i", rays, rays)
    gap = np.linalg.norm(towards - along[:, None] * rays, axis=1)
    near = gap < 1.001 * mesh.radius + 1e-6
    margins = np.full(len(rays), -np.inf)
    if near.any():
        margins[near] = ray_margins(mesh.corners, apex, rays[near])
    return margins


def ray_lengths(corners, origin, directions):
    """Return the distance of each ray to its first hit, in units of its direction; inf: none."""
    a = corners[:, 0]
    e1, e2, s = corners[:, 1] - a, corners[:, 2] - a, origin - a
    det = directions @ np.cross(e2, e1).T
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (directions @ np.cross(e2, s).T) / det
        v = (directions @ np.cross(s, e1).T) / det
        t = np.einsum("ij,ij->i", e2, np.cross(s, e1)) / det
        hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t >= 0.0) & (det != 0.0)
    return np.where(hit, t, np.inf).min(axis=1)
