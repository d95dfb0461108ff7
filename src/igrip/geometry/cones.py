"""Cones of rays: their frame, their rays, and what they cannot meet. In the frame of a mesh."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel

# columns of a description of cones, see igrip.geometry.kernel.measure
SLOW, SLOW_ANGLE, FAST, FAST_ANGLE, LEAST = 0, 1, 2, 3, 4


@kernel
def cone_tangent(speed, cone):
    """Return the tangent of the half-angle of the cone at a local speed, interpolated linearly."""
    part = (speed - cone[SLOW]) / (cone[FAST] - cone[SLOW])
    part = min(1.0, max(0.0, part))
    return np.tan(cone[SLOW_ANGLE] + part * (cone[FAST_ANGLE] - cone[SLOW_ANGLE]))


@kernel
def _perpendicular(ax, ay, az, wx, wy, wz):
    """Return the unit part of w at right angles to the unit vector a, and whether there is one."""
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

    The ray pattern has to be turned somehow about the axis. Anything tied to the world would make
    the number of impacts depend on how the world is turned, so the first ray of the pattern leans
    towards the centre of the object.

    Parameters
    ----------
    p, v : (3,)
        Apex and velocity, in the frame of the mesh.
    sphere : (4,)
        Bounding sphere of the mesh, centre and radius [m].
    axis : (3, 3)
        Object axes by columns, a fallback where the centre lies on the cone's axis.
    frame : (3, 3), written
        Rows: the unit axis and two unit vectors at right angles to it.
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
    """Return a sphere as :func:`ray_can_meet` wants it, seen from the apex ``p`` of a cone."""
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

    ``ahead, aside, across`` are the parts of the sphere's centre, seen from the apex, along axis, u
    and v; ``gap2`` is its squared distance less the squared radius.
    """
    if gap2 <= 0.0:
        return True
    along = ahead + a * aside + b * across
    return along > 0.0 and gap2 * (1.0 + a * a + b * b) <= along * along
