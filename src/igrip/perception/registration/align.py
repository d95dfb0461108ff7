"""Move a mesh until points lie on it: Gauss-Newton steps on its distance field."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.perception.registration.signed_distance import look_up

Array = NDArray[np.float64]


class RigidPose(NamedTuple):
    """A pose: from the frame of a mesh to another.

    Attributes
    ----------
    rotation : (3, 3)
    translation : (3,)
        [m].
    """

    rotation: Array
    translation: Array

    def apply(self, points: Array) -> Array:
        """Return points of the mesh, (n, 3) or (3,), in the other frame [m]."""
        moved: Array = points @ self.rotation.T + self.translation
        return moved

    def to_mesh(self, points: Array) -> Array:
        """Return points of the other frame, (n, 3), in that of the mesh [m]."""
        moved: Array = (points - self.translation) @ self.rotation
        return moved

    def after(self, pose: Array) -> RigidPose:
        """Return this pose, carried on by another, (4, 4)."""
        return RigidPose(
            pose[:3, :3] @ self.rotation, pose[:3, :3] @ self.translation + pose[:3, 3]
        )


class Resting(NamedTuple):
    """How a mesh rests on the table, as a weak prior of its pose.

    Attributes
    ----------
    up : (3,)
        Direction of the mesh that points up.
    height : float
        Of the centre of the mesh over the table [m].
    weight : float
        Of this, in shares of the points; 0: it may be anywhere.
    """

    up: Array
    height: float
    weight: float


class Annealing(NamedTuple):
    """The steps of a fit; points farther off than the gate do not count (Tukey's biweight).

    Attributes
    ----------
    first_gate, last_gate : float
        At the first and at the last step [m].
    steps : int
    """

    first_gate: float
    last_gate: float
    steps: int


@kernel
def rotate_about(pose, centre, w, shift):
    """Turn a pose by the rotation vector w (3,) about a point, then shift it; in place."""
    rotation, translation = pose
    angle = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    q = np.eye(3)
    if angle > 1e-12:
        x, y, z = w[0] / angle, w[1] / angle, w[2] / angle
        s, c = np.sin(angle), np.cos(angle)
        d = 1.0 - c
        q[0, 0], q[0, 1], q[0, 2] = c + x * x * d, x * y * d - z * s, x * z * d + y * s
        q[1, 0], q[1, 1], q[1, 2] = y * x * d + z * s, c + y * y * d, y * z * d - x * s
        q[2, 0], q[2, 1], q[2, 2] = z * x * d - y * s, z * y * d + x * s, c + z * z * d
    old = rotation.copy()
    away = translation - centre
    for i in range(3):
        translation[i] = centre[i] + shift[i]
        for j in range(3):
            translation[i] += q[i, j] * away[j]
            total = 0.0
            for k in range(3):
                total += q[i, k] * old[k, j]
            rotation[i, j] = total


@kernel
def align(points, surface, pose, resting, planar, annealing, information):
    """Fit the pose of a mesh to points, in the frame of a table (z up) or any other.

    Parameters
    ----------
    points : (n, 3)
        Measured [m].
    surface : igrip.perception.registration.shape.Surface
        Of the mesh.
    pose : RigidPose, changed in place
        Table-from-mesh.
    resting : Resting
        A prior.
    planar : bool
        Whether it may move along x and y and turn about z only.
    annealing : Annealing
        Gates and steps.
    information : (6, 6), written
        Sum of the weighted outer products of the derivatives at the last step.

    Returns
    -------
    rms, weight : float
        Weighted root mean square of the distances [m] and the sum of the weights at the last step.
    """
    rotation, translation = pose
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
            x, y, z = (
                points[n, 0] - translation[0],
                points[n, 1] - translation[1],
                points[n, 2] - translation[2],
            )
            r = look_up(
                surface.field,
                rotation[0, 0] * x + rotation[1, 0] * y + rotation[2, 0] * z,
                rotation[0, 1] * x + rotation[1, 1] * y + rotation[2, 1] * z,
                rotation[0, 2] * x + rotation[1, 2] * y + rotation[2, 2] * z,
                g,
            )  # fmt: skip
            if abs(r) >= limit:
                continue
            weight = (1.0 - (r / limit) ** 2) ** 2
            gx = rotation[0, 0] * g[0] + rotation[0, 1] * g[1] + rotation[0, 2] * g[2]
            gy = rotation[1, 0] * g[0] + rotation[1, 1] * g[1] + rotation[1, 2] * g[2]
            gz = rotation[2, 0] * g[0] + rotation[2, 1] * g[1] + rotation[2, 2] * g[2]
            x, y, z = points[n, 0] - about[0], points[n, 1] - about[1], points[n, 2] - about[2]
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
            ux = rotation[0, 0] * up[0] + rotation[0, 1] * up[1] + rotation[0, 2] * up[2]
            uy = rotation[1, 0] * up[0] + rotation[1, 1] * up[1] + rotation[1, 2] * up[2]
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
        rotate_about(pose, about, w, shift)
    return rms, total
