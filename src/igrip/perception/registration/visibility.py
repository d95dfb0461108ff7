"""How a mesh in a pose agrees with a depth picture: visible, hidden, or not there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from igrip.compiled import kernel
from igrip.perception.registration.rigid_pose import rotate, rotate_back
from igrip.perception.registration.signed_distance import look_up

MIN_COSINE = 0.15  # between surface and line of sight; at less nothing is concluded
CLEAR = 0.003  # first step from the surface towards the camera [m]
STEP = 2  # between the nine pixels a depth is averaged over
SLOPE = 0.012  # how far they may be from the one in the middle, besides noise [m]; guess


class Visibility(NamedTuple):
    """Shares of the area that would be visible if nothing stood before it."""

    match: float  # measured where it should be
    fit: float  # the same, weighted by how well
    through: float  # measured farther away: the mesh is not there
    hidden: float  # measured nearer: something stands before it
    missing: float  # not measured
    outside: float  # out of the picture


@kernel
def local_depth(depth, u, v):
    """Return the mean depth of nine pixels about one, without those of another surface; 0: none.

    Errors of stereo are alike over a few pixels; hence pixels two apart.
    """
    middle = depth[v, u]
    if not middle > 0.0:
        return 0.0
    near = SLOPE + 0.015 * middle * middle
    total, count = 0.0, 0
    for i in range(-STEP, STEP + 1, STEP):
        for j in range(-STEP, STEP + 1, STEP):
            if 0 <= v + i < depth.shape[0] and 0 <= u + j < depth.shape[1]:
                z = depth[v + i, u + j]
                if z > 0.0 and abs(z - middle) < near:
                    total += z
                    count += 1
    return total / count


@kernel
def local_depths(depth, stride, nearest, farthest, out):
    """Write the local depth of every ``stride``-th pixel, 0 where it is out of reach [m]."""
    for v in range(out.shape[0]):
        for u in range(out.shape[1]):
            z = local_depth(depth, u * stride, v * stride)
            out[v, u] = z if nearest <= z <= farthest else 0.0


@kernel
def _is_self_occluded(values, origin, cell, x, y, z, dx, dy, dz, far, gradient):
    """Whether a mesh is between a point on it and the camera in this direction (unit vector)."""
    s = CLEAR + 0.5 * cell
    while s < far:
        away = look_up(values, origin, cell, x + s * dx, y + s * dy, z + s * dz, gradient)
        if away < -0.001:
            return True
        s += max(away, 0.004)
    return False


@kernel
def compare_with_depth(view, pose, surface):
    """Return the :class:`Visibility` of a mesh, of the side that faces the camera.

    Parameters
    ----------
    view : igrip.perception.registration.view.DepthView
        The picture, and within which distance a measurement fits.
    pose : igrip.perception.registration.rigid_pose.RigidPose
        Camera-from-mesh.
    surface : igrip.perception.registration.shape.Surface
        Of the mesh.
    """
    rotation, t = pose
    values, origin, cell = surface.field
    points, normals, far = surface.points, surface.normals, 2.0 * surface.radius
    depth, mask, intrinsics = view.depth, view.mask, view.intrinsics
    g = np.empty(3)
    match, fit, through, hidden, missing, outside = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    total = 0.0
    # the camera, in the frame of the mesh
    ex, ey, ez = rotate_back(rotation, t[0], t[1], t[2])
    ex, ey, ez = -ex, -ey, -ez
    for n in range(points.shape[0]):
        sx, sy, sz = points[n, 0], points[n, 1], points[n, 2]
        dx, dy, dz = ex - sx, ey - sy, ez - sz
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        dx, dy, dz = dx / length, dy / length, dz / length
        weight = dx * normals[n, 0] + dy * normals[n, 1] + dz * normals[n, 2]
        if weight < MIN_COSINE:
            continue
        if _is_self_occluded(values, origin, cell, sx, sy, sz, dx, dy, dz, far, g):
            continue
        total += weight
        x, y, z = rotate(rotation, sx, sy, sz)
        x, y, z = x + t[0], y + t[1], z + t[2]
        if z <= 0.0:
            outside += weight
            continue
        u = int(np.floor(intrinsics.fx * x / z + intrinsics.cx + 0.5))
        v = int(np.floor(intrinsics.fy * y / z + intrinsics.cy + 0.5))
        if u < 0 or v < 0 or u >= depth.shape[1] or v >= depth.shape[0]:
            outside += weight
            continue
        measured = local_depth(depth, u, v)
        if mask[v, u]:
            hidden += weight
            continue
        if not measured > 0.0:
            missing += weight
            continue
        # how far along the normal the measured point is from the surface: the way along the line
        # of sight, z over the measured depth as everything on it, times the cosine
        gap = (1.0 - measured / z) * length * weight
        limit = view.tolerance + 2.5 * view.noise * z * z
        if abs(gap) < limit:
            match += weight
            fit += weight * (1.0 - (gap / limit) ** 2)
        elif gap > 0.0:
            hidden += weight
        else:
            through += weight
    total = total if total > 0.0 else 1.0
    return Visibility(
        match / total, fit / total, through / total, hidden / total, missing / total,
        outside / total,
    )  # fmt: skip


@kernel
def share_explained(points, depths, pose, surface, view):
    """Return which share of points (n, 3) lies on a mesh, weighted by how well.

    ``depths`` (n,) are theirs along the optical axis; ``pose`` is that of the mesh in the frame of
    the points.
    """
    rotation, t = pose
    values, origin, cell = surface.field
    g = np.empty(3)
    well = 0.0
    for n in range(points.shape[0]):
        x, y, z = points[n, 0] - t[0], points[n, 1] - t[1], points[n, 2] - t[2]
        x, y, z = rotate_back(rotation, x, y, z)
        r = look_up(values, origin, cell, x, y, z, g)
        limit = view.tolerance + 2.5 * view.noise * depths[n] * depths[n]
        if abs(r) < limit:
            well += 1.0 - (r / limit) ** 2
    return well / max(points.shape[0], 1)
