"""The measured points near a mesh in a pose: what a tracked object is fitted to."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.perception.registration.signed_distance import look_up
from igrip.perception.registration.visibility import local_depth


@kernel
def points_near(
    depth, mask, pinhole, table_from_camera, rotation, translation, middle, radius,
    values, origin, cell, gate, lowest, spread, stride, points, depths,
):  # fmt: skip
    """Collect measured points near a mesh.

    Parameters
    ----------
    depth, mask, pinhole
        As for :func:`igrip.perception.registration.visibility.judge`.
    table_from_camera : (4, 4)
        Pose of the camera in the frame of the table.
    rotation : (3, 3), translation : (3,)
        Table-from-mesh.
    middle, radius, values, origin, cell
        Of the shape.
    gate : float
        Points farther from the surface are left out [m].
    lowest, spread : float
        And those lower over the table than ``lowest + 3 spread z²`` [m, 1/m].
    stride : int
        Only every so many pixels.
    points : (n, 3), depths : (n,), written
        In the frame of the table, and along the optical axis [m].

    Returns
    -------
    int
        How many; at most n.
    """
    t = table_from_camera
    about = np.empty(3)
    g = np.empty(3)
    for i in range(3):
        about[i] = translation[i] - t[i, 3]
        for k in range(3):
            about[i] += rotation[i, k] * middle[k]
    x = t[0, 0] * about[0] + t[1, 0] * about[1] + t[2, 0] * about[2]
    y = t[0, 1] * about[0] + t[1, 1] * about[1] + t[2, 1] * about[2]
    z = t[0, 2] * about[0] + t[1, 2] * about[1] + t[2, 2] * about[2]
    reach = radius + gate
    if z - reach <= 0.05:
        return 0
    half_x, half_y = pinhole[0] * reach / (z - reach), pinhole[1] * reach / (z - reach)
    u0, v0 = pinhole[0] * x / z + pinhole[2], pinhole[1] * y / z + pinhole[3]
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
            a, b = (u - pinhole[2]) / pinhole[0] * d, (v - pinhole[3]) / pinhole[1] * d
            px = t[0, 0] * a + t[0, 1] * b + t[0, 2] * d + t[0, 3]
            py = t[1, 0] * a + t[1, 1] * b + t[1, 2] * d + t[1, 3]
            pz = t[2, 0] * a + t[2, 1] * b + t[2, 2] * d + t[2, 3]
            if pz < lowest + 3.0 * spread * d * d:
                continue
            x, y, w = px - translation[0], py - translation[1], pz - translation[2]
            away = look_up(
                values, origin, cell,
                rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0] * w,
                rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1] * w,
                rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2] * w,
                g,
            )  # fmt: skip
            if abs(away) > gate:
                continue
            if count == points.shape[0]:
                return count
            points[count, 0], points[count, 1], points[count, 2] = px, py, pz
            depths[count] = d
            count += 1
    return count
