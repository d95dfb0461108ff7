"""Move a mesh until points lie on it: Gauss-Newton steps on its distance field."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from igrip.compiled import kernel
from igrip.perception.registration.rigid_pose import rotate, rotate_back, turn_about
from igrip.perception.registration.signed_distance import look_up
from igrip.rgbd import Array


class Resting(NamedTuple):
    """How a mesh rests on the table, as a weak prior of its pose."""

    up: Array  # (3,), direction of the mesh that points up
    height: float  # of the centre of the mesh over the table [m]
    weight: float  # of this prior, in shares of the points; 0: it may be anywhere


class Annealing(NamedTuple):
    """The steps of a fit; points farther off than the gate do not count (Tukey's biweight)."""

    first_gate: float  # at the first step [m]
    last_gate: float  # at the last step [m]
    steps: int


@kernel
def align(points, surface, pose, resting, planar, annealing, information):
    """Fit the pose of a mesh to points (n, 3) of the frame of a table, z up [m].

    Parameters
    ----------
    points, surface, resting, annealing
        The points, the :class:`igrip.perception.registration.shape.Surface` of the mesh, the prior
        and the steps.
    pose : RigidPose, changed in place
        Table-from-mesh.
    planar : bool
        Whether it may move along x and y and turn about z only.
    information : (6, 6), written
        Sum of the weighted outer products of the derivatives at the last step.

    Returns
    -------
    rms, weight : float
        Weighted root mean square of the distances [m] and the sum of the weights at the last step.
    """
    rotation, translation = pose
    values, origin, cell = surface.field
    radius, middle = surface.radius, surface.centre
    up, height, hold = resting
    widest, narrowest, steps = annealing
    a = np.empty((6, 6))
    b = np.empty(6)
    j = np.empty(6)
    g = np.empty(3)
    about = np.empty(3)
    shift = np.zeros(3)
    w = np.zeros(3)
    rms, total = np.inf, 0.0
    for step in range(steps):
        share = step / max(steps - 1, 1)
        limit = widest * (narrowest / widest) ** share
        for i in range(3):
            about[i] = translation[i]
            for k in range(3):
                about[i] += rotation[i, k] * middle[k]
        a[:] = 0.0
        b[:] = 0.0
        total, squares = 0.0, 0.0
        for n in range(points.shape[0]):
            x, y, z = points[n, 0], points[n, 1], points[n, 2]
            mx, my, mz = rotate_back(
                rotation, x - translation[0], y - translation[1], z - translation[2]
            )
            r = look_up(values, origin, cell, mx, my, mz, g)
            if abs(r) >= limit:
                continue
            weight = (1.0 - (r / limit) ** 2) ** 2
            gx, gy, gz = rotate(rotation, g[0], g[1], g[2])
            x, y, z = x - about[0], y - about[1], z - about[2]
            j[0], j[1], j[2] = -gx, -gy, -gz
            j[3], j[4], j[5] = -(y * gz - z * gy), -(z * gx - x * gz), -(x * gy - y * gx)
            for p in range(6):
                b[p] -= weight * j[p] * r
                for q in range(p + 1):
                    a[p, q] += weight * j[p] * j[q]
            total += weight
            squares += weight * r * r
        for p in range(6):
            for q in range(p):
                a[q, p] = a[p, q]
        if total < 6.0:
            return np.inf, total
        rms = np.sqrt(squares / total)
        information[:] = a
        if hold > 0.0:
            ux, uy, _ = rotate(rotation, up[0], up[1], up[2])
            lean = hold * total * radius * radius
            a[2, 2] += hold * total
            b[2] -= hold * total * (about[2] - height)
            a[3, 3] += lean
            b[3] += lean * uy  # a turn by w takes the direction up by (w_y, -w_x)
            a[4, 4] += lean
            b[4] -= lean * ux
        for p in range(6):
            held = planar and (p == 2 or p == 3 or p == 4)
            if held:
                a[p, :] = 0.0
                a[:, p] = 0.0
                a[p, p] = 1.0
                b[p] = 0.0
            else:  # Levenberg: what the points leave open stays as it is
                a[p, p] += 1e-3 * total * (1.0 if p < 3 else radius * radius)
        d = np.linalg.solve(a, b)
        for i in range(3):
            shift[i] = min(max(d[i], -widest), widest)
            w[i] = min(max(d[3 + i], -0.3), 0.3)
        turn_about(pose, about, w, shift)
    return rms, total
