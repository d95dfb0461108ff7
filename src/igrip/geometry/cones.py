"""Cones of rays: their frame, their rays, and tests of what they cannot meet. Mesh frame."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

Array = NDArray[np.float64]
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


class Cones(NamedTuple):
    """The cones of rays of a :class:`igrip.geometry.scene.RayConfig`.

    Attributes
    ----------
    pattern : (r, 2)
        Rays of a cone on the unit disc; the first is the axis.
    slow_speed, slow_angle, fast_speed, fast_angle : float
        Half-angle by speed [m/s, rad].
    min_speed : float
        A slower point has no cone [m/s].
    """

    pattern: Array
    slow_speed: float
    slow_angle: float
    fast_speed: float
    fast_angle: float
    min_speed: float


def ray_pattern(rays: int) -> Array:
    """Return points on the unit disc, evenly spread, the first its centre, shape (rays, 2)."""
    k = np.arange(rays)
    radius = np.sqrt(k / max(1, rays - 1))
    angle = GOLDEN_ANGLE * np.maximum(0, k - 1)  # the first ray off the axis leans along u
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


@kernel
def cone_tangent(speed, slow_speed, slow_angle, fast_speed, fast_angle):
    """Return the tangent of the half-angle of the cone at a local speed, interpolated linearly."""
    part = (speed - slow_speed) / (fast_speed - slow_speed)
    part = min(1.0, max(0.0, part))
    return np.tan(slow_angle + part * (fast_angle - slow_angle))


@kernel
def _perpendicular(ax, ay, az, wx, wy, wz):
    """Return the unit component of w perpendicular to the unit vector a, and whether it exists."""
    along = ax * wx + ay * wy + az * wz
    ux, uy, uz = wx - along * ax, wy - along * ay, wz - along * az
    length = np.sqrt(ux * ux + uy * uy + uz * uz)
    size = np.sqrt(wx * wx + wy * wy + wz * wz)
    if not length > 1e-9 * size:
        return 0.0, 0.0, 0.0, False
    return ux / length, uy / length, uz / length, True


@kernel
def cone_frame(p, v, sphere, axis, frame):
    """Place a cone: its axis along v, its roll fixed by the object alone.

    The ray pattern needs a roll about the axis. A roll tied to the world would make the number of
    impacts depend on the world's orientation, so the first ray of the pattern leans towards the
    centre of the object (docs/decisions/0001-roll-of-the-cones.md).

    Parameters
    ----------
    p, v : (3,)
        Apex and velocity, in the frame of the mesh.
    sphere : (4,)
        Bounding sphere of the mesh, centre and radius [m].
    axis : (3, 3)
        Object axes by columns, a fallback where the centre lies on the cone's axis.
    frame : (3, 3), written
        Rows: the unit axis and two unit vectors u, v perpendicular to it.
    """
    speed = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    ax, ay, az = v[0] / speed, v[1] / speed, v[2] / speed
    ux, uy, uz, found = _perpendicular(
        ax, ay, az, sphere[0] - p[0], sphere[1] - p[1], sphere[2] - p[2]
    )
    for column in (2, 0):
        if not found:
            ux, uy, uz, found = _perpendicular(
                ax, ay, az, axis[0, column], axis[1, column], axis[2, column]
            )
    frame[0, 0], frame[0, 1], frame[0, 2] = ax, ay, az
    frame[1, 0], frame[1, 1], frame[1, 2] = ux, uy, uz
    frame[2, 0], frame[2, 1] = ay * uz - az * uy, az * ux - ax * uz
    frame[2, 2] = ax * uy - ay * ux


@kernel
def ray_direction(frame, tangent, pattern, k, out):
    """Write the direction of ray k of the pattern; its component along the axis is 1."""
    a, b = tangent * pattern[k, 0], tangent * pattern[k, 1]
    for axis in range(3):
        out[axis] = frame[0, axis] + a * frame[1, axis] + b * frame[2, axis]


@kernel
def cone_can_meet(v, tangent, p, sphere):
    """Whether any ray inside the cone about v can meet the bounding sphere."""
    cx, cy, cz = sphere[0] - p[0], sphere[1] - p[1], sphere[2] - p[2]
    radius = sphere[3]
    speed = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    along = (v[0] * cx + v[1] * cy + v[2] * cz) / speed
    distance2 = cx * cx + cy * cy + cz * cz
    if distance2 <= radius * radius:
        return True
    # distance of the centre from the surface of the cone, in the plane through axis and centre
    across = np.sqrt(max(0.0, distance2 - along * along))
    cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
    sine = tangent * cosine
    if across * cosine - along * sine > radius:
        return False
    return along * cosine + across * sine > -radius


@kernel
def sphere_from(frame, p, sphere):
    """Return the arguments of :func:`ray_can_meet` for a sphere and a cone with apex ``p``."""
    ahead = aside = across = 0.0
    gap2 = -sphere[3] * sphere[3]
    for axis in range(3):
        away = sphere[axis] - p[axis]
        ahead += frame[0, axis] * away
        aside += frame[1, axis] * away
        across += frame[2, axis] * away
        gap2 += away * away
    return ahead, aside, across, gap2


@kernel
def ray_can_meet(ahead, aside, across, gap2, a, b):
    """Whether the ray ``axis + a u + b v`` can meet a sphere, before it is even computed.

    ``ahead, aside, across`` are the coordinates of the sphere's centre relative to the apex, along
    the cone's axis, u and v; ``gap2`` is its squared distance minus the squared radius.
    """
    if gap2 <= 0.0:
        return True
    along = ahead + a * aside + b * across
    return along > 0.0 and gap2 * (1.0 + a * a + b * b) <= along * along
