"""The compiled renderer: the depth of placed meshes, pixel by pixel."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.mesh.bvh import STACK
from igrip.mesh.ray import cast_ray


@kernel
def draw_mesh(
    boxes, links, leaves, mesh_from_camera, sphere, intrinsics, label, depth, labels
):  # fmt: skip
    """Draw one mesh into a depth picture, nearer than what is there already.

    Parameters
    ----------
    boxes, links, leaves
        Arrays of its tree (:class:`igrip.mesh.bvh.Bvh`).
    mesh_from_camera : (4, 4)
        Pose of the camera in the frame of the mesh.
    sphere : (4,)
        Centre, in the camera's frame, and radius of a sphere round the mesh [m].
    label : int
        Written to ``labels`` (h, w) where the mesh is seen.
    depth : (h, w) float64, written
        Along the optical axis [m]; infinity for nothing.
    """
    height, width = depth.shape
    _, _, fx, fy, cx, cy = intrinsics
    x, y, z, radius = sphere[0], sphere[1], sphere[2], sphere[3]
    nearest = z - radius
    if z + radius <= 0.0:
        return
    left, right, top, bottom = 0, width, 0, height
    if nearest > 0.05:  # closer by, the sphere may fill the picture
        low, high = x - radius, x + radius
        left = max(left, int(np.floor(fx * min(low / nearest, low / z) + cx)))
        right = min(right, int(np.ceil(fx * max(high / nearest, high / z) + cx)) + 1)
        low, high = y - radius, y + radius
        top = max(top, int(np.floor(fy * min(low / nearest, low / z) + cy)))
        bottom = min(bottom, int(np.ceil(fy * max(high / nearest, high / z) + cy)) + 1)
    stack = np.empty(STACK, dtype=np.int32)
    counters = np.zeros(1, dtype=np.int64)
    px, py, pz = mesh_from_camera[0, 3], mesh_from_camera[1, 3], mesh_from_camera[2, 3]
    for v in range(top, bottom):
        b = (v - cy) / fy
        for u in range(left, right):
            a = (u - cx) / fx
            # its unit of length is a metre along the optical axis
            dx = mesh_from_camera[0, 0] * a + mesh_from_camera[0, 1] * b + mesh_from_camera[0, 2]
            dy = mesh_from_camera[1, 0] * a + mesh_from_camera[1, 1] * b + mesh_from_camera[1, 2]
            dz = mesh_from_camera[2, 0] * a + mesh_from_camera[2, 1] * b + mesh_from_camera[2, 2]
            t = cast_ray(
                boxes, links, leaves, 0, 0, px, py, pz, dx, dy, dz, stack, counters
            )  # fmt: skip
            if t < depth[v, u]:
                depth[v, u] = t
                labels[v, u] = label
