"""The measured points near a mesh in a pose: what a tracked object is fitted to."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.perception.registration.clusters import MIN_HEIGHT
from igrip.perception.registration.rigid_pose import RigidPose, rotate, rotate_back
from igrip.perception.registration.shape import Surface
from igrip.perception.registration.signed_distance import look_up
from igrip.perception.registration.view import DepthView
from igrip.perception.registration.visibility import local_depth
from igrip.rgbd import Array

GATE = 0.03  # points farther from the surface are left out [m]; 0.9 m/s at 30 Hz
LOWEST = MIN_HEIGHT - 0.004  # and points lower over the table, besides noise [m]


def points_near(
    view: DepthView, pose: RigidPose, surface: Surface, count: int
) -> tuple[Array, Array]:
    """Return measured points near a mesh, in the frame of the table (n, 3) [m], and their depths.

    There are about ``count``, seldom more than four times that. ``pose`` is table-from-mesh.
    """
    centre = pose.rotation @ surface.centre + pose.translation
    away = view.camera_from_table[:3, :3] @ centre
    z = max(0.1, float(away[2] + view.camera_from_table[2, 3]))
    pixels = (view.intrinsics.fx * surface.radius / z) ** 2  # of its side, about
    stride = max(1, round(float(np.sqrt(pixels / count))))
    points, depths = np.empty((4 * count, 3)), np.empty(4 * count)
    n = _collect(view, pose, surface, stride, points, depths)
    return points[:n], depths[:n]


@kernel
def _collect(view, pose, surface, stride, points, depths):
    """Write points (n, 3) and depths (n,) of every ``stride``-th pixel; return how many."""
    rotation, translation = pose
    values, origin, cell = surface.field
    depth, mask, camera, t = view.depth, view.mask, view.intrinsics, view.table_from_camera
    about = np.empty(3)
    g = np.empty(3)
    for i in range(3):
        about[i] = translation[i] - t[i, 3]
        for k in range(3):
            about[i] += rotation[i, k] * surface.centre[k]
    x, y, z = rotate_back(t, about[0], about[1], about[2])
    reach = surface.radius + GATE
    if z - reach <= 0.05:
        return 0
    half_x, half_y = camera.fx * reach / (z - reach), camera.fy * reach / (z - reach)
    u0, v0 = camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy
    left, right = max(0, int(u0 - half_x)), min(depth.shape[1], int(u0 + half_x) + 1)
    top, bottom = max(0, int(v0 - half_y)), min(depth.shape[0], int(v0 + half_y) + 1)
    count = 0
    for v in range(top, bottom, stride):
        for u in range(left, right, stride):
            if mask[v, u]:
                continue
            raw = depth[v, u]
            if abs(raw - z) > reach or not raw > 0.0:
                continue
            d = local_depth(depth, u, v)
            a, b = (u - camera.cx) / camera.fx * d, (v - camera.cy) / camera.fy * d
            px, py, pz = rotate(t, a, b, d)
            px, py, pz = px + t[0, 3], py + t[1, 3], pz + t[2, 3]
            if pz < LOWEST + 3.0 * view.noise * d * d:
                continue
            mx, my, mz = px - translation[0], py - translation[1], pz - translation[2]
            mx, my, mz = rotate_back(rotation, mx, my, mz)
            if abs(look_up(values, origin, cell, mx, my, mz, g)) > GATE:
                continue
            if count == points.shape[0]:
                return count
            points[count, 0], points[count, 1], points[count, 2] = px, py, pz
            depths[count] = d
            count += 1
    return count
