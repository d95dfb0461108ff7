"""What a depth picture says of a mesh in a pose: seen, hidden, or seen through."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.perception.registration.signed_distance import look_up

MATCH, FIT, THROUGH, HIDDEN, MISSING, OUTSIDE = 0, 1, 2, 3, 4, 5  # places in the evidence
GRAZING = 0.15  # a surface seen at a lesser cosine says nothing
CLEAR = 0.003  # first step from the surface towards the camera [m]


STEP = 2  # between the nine pixels a depth is averaged over
SLOPE = 0.012  # how far they may be from the one in the middle, besides noise [m]; guess


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
def smoothed(depth, stride, nearest, farthest, out):
    """Write the local depth of every ``stride``-th pixel, 0 where it is out of reach [m]."""
    for v in range(out.shape[0]):
        for u in range(out.shape[1]):
            z = local_depth(depth, u * stride, v * stride)
            out[v, u] = z if nearest <= z <= farthest else 0.0


@kernel
def tolerance(z, base, spread):
    """Return within which distance a measurement at depth z fits [m]."""
    return base + 2.5 * spread * z * z


@kernel
def _hides_itself(values, origin, cell, x, y, z, dx, dy, dz, far, gradient):
    """Whether a mesh is between a point on it and the camera in this direction (unit vector)."""
    s = CLEAR + 0.5 * cell
    while s < far:
        away = look_up(values, origin, cell, x + s * dx, y + s * dy, z + s * dz, gradient)
        if away < -0.001:
            return True
        s += max(away, 0.004)
    return False


@kernel
def judge(
    depth, mask, pinhole, rotation, translation, samples, normals,
    values, origin, cell, radius, base, spread, evidence,
):  # fmt: skip
    """Compare the side of a mesh that faces the camera with a depth picture.

    Parameters
    ----------
    depth : (h, w) float32
        Measured [m]; 0 for nothing.
    mask : (h, w) uint8
        1 where something else is known to be in front, as a hand.
    pinhole : (4,)
        fx, fy, cx, cy [pixels].
    rotation : (3, 3), translation : (3,)
        Camera-from-mesh.
    samples, normals : (n, 3)
        Points spread evenly over the surface, and its outward unit normals.
    values, origin, cell
        Distance field of the mesh.
    radius : float
        Of the mesh [m].
    base, spread : float
        Tolerance: ``base + 2.5 spread z²`` [m, 1/m].
    evidence : (6,), written
        Visible area, in shares of what faces the camera: of it measured where it should be (MATCH),
        the same weighted by how well (FIT), measured farther away (THROUGH), nearer (HIDDEN), not
        measured (MISSING), and out of the picture (OUTSIDE).
    """
    g = np.empty(3)
    evidence[:] = 0.0
    total = 0.0
    # the camera, in the frame of the mesh
    ex = -(rotation[0, 0] * translation[0] + rotation[1, 0] * translation[1]
           + rotation[2, 0] * translation[2])  # fmt: skip
    ey = -(rotation[0, 1] * translation[0] + rotation[1, 1] * translation[1]
           + rotation[2, 1] * translation[2])  # fmt: skip
    ez = -(rotation[0, 2] * translation[0] + rotation[1, 2] * translation[1]
           + rotation[2, 2] * translation[2])  # fmt: skip
    for n in range(samples.shape[0]):
        sx, sy, sz = samples[n, 0], samples[n, 1], samples[n, 2]
        dx, dy, dz = ex - sx, ey - sy, ez - sz
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        dx, dy, dz = dx / length, dy / length, dz / length
        weight = dx * normals[n, 0] + dy * normals[n, 1] + dz * normals[n, 2]
        if weight < GRAZING:
            continue
        if _hides_itself(values, origin, cell, sx, sy, sz, dx, dy, dz, 2.0 * radius, g):
            continue
        total += weight
        x = rotation[0, 0] * sx + rotation[0, 1] * sy + rotation[0, 2] * sz + translation[0]
        y = rotation[1, 0] * sx + rotation[1, 1] * sy + rotation[1, 2] * sz + translation[1]
        z = rotation[2, 0] * sx + rotation[2, 1] * sy + rotation[2, 2] * sz + translation[2]
        if z <= 0.0:
            evidence[OUTSIDE] += weight
            continue
        u = int(np.floor(pinhole[0] * x / z + pinhole[2] + 0.5))
        v = int(np.floor(pinhole[1] * y / z + pinhole[3] + 0.5))
        if u < 0 or v < 0 or u >= depth.shape[1] or v >= depth.shape[0]:
            evidence[OUTSIDE] += weight
            continue
        seen = local_depth(depth, u, v)
        if mask[v, u]:
            evidence[HIDDEN] += weight
            continue
        if not seen > 0.0:
            evidence[MISSING] += weight
            continue
        # how far along the normal the measured point is from the surface: the way along the line
        # of sight, z over seen as everything on it, times the cosine
        gap = (1.0 - seen / z) * length * weight
        limit = tolerance(z, base, spread)
        if abs(gap) < limit:
            evidence[MATCH] += weight
            evidence[FIT] += weight * (1.0 - (gap / limit) ** 2)
        elif gap > 0.0:
            evidence[HIDDEN] += weight
        else:
            evidence[THROUGH] += weight
    if total > 0.0:
        evidence /= total


@kernel
def explained(points, depths, rotation, translation, values, origin, cell, base, spread):
    """Return the share of points (n, 3), at these depths (n,), that lie on the mesh, and how well.

    The pose is that of the mesh in the frame of the points.
    """
    g = np.empty(3)
    on, well = 0.0, 0.0
    for n in range(points.shape[0]):
        x, y, z = (
            points[n, 0] - translation[0],
            points[n, 1] - translation[1],
            points[n, 2] - translation[2],
        )
        r = look_up(
            values, origin, cell,
            rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0] * z,
            rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1] * z,
            rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2] * z,
            g,
        )  # fmt: skip
        limit = tolerance(depths[n], base, spread)
        if abs(r) < limit:
            on += 1.0
            well += 1.0 - (r / limit) ** 2
    return on / max(points.shape[0], 1), well / max(points.shape[0], 1)
