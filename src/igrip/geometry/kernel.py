"""The one compiled kernel of a frame: every hand against every object."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.geometry.bvh import STACK
from igrip.geometry.cones import (
    LEAST,
    cone_can_meet,
    cone_frame,
    cone_tangent,
    ray_can_meet,
    ray_direction,
)
from igrip.geometry.query import cast_ray, nearest

RAY_NODES, POINT_NODES, RAYS = 0, 1, 2  # counters


@kernel
def _to_mesh(rotation, translation, p, out):
    x, y, z = p[0] - translation[0], p[1] - translation[1], p[2] - translation[2]
    for axis in range(3):
        out[axis] = rotation[0, axis] * x + rotation[1, axis] * y + rotation[2, axis] * z


@kernel
def _turn_to_mesh(rotation, v, out):
    for axis in range(3):
        out[axis] = rotation[0, axis] * v[0] + rotation[1, axis] * v[1] + rotation[2, axis] * v[2]


@kernel
def _distance2(p, x, y, z):
    """Return a squared distance, with room for the rounding of another way to compute it."""
    return ((x - p[0]) ** 2 + (y - p[1]) ** 2 + (z - p[2]) ** 2) * (1.0 + 1e-12) + 1e-300


@kernel
def measure(
    boxes, links, triangles, starts, spheres, axes, origins, models, rotations, translations,
    centres, centre_velocities, positions, velocities, futures, future_velocities, pattern, cone,
    hits, distances, centre_rates, axial, counters,
):  # fmt: skip
    """Measure every hand against every object.

    Parameters
    ----------
    boxes, links, triangles
        Trees of all meshes, one after the other (:class:`igrip.geometry.bvh.Bvh`).
    starts : (m, 2) int64
        First node and first triangle of each mesh.
    spheres : (m, 4), axes : (m, 3, 3), origins : (m, 3)
        Bounding sphere, object axes and origin of the object frame of each mesh, in its frame.
    models : (o,) int64
        Which mesh each object has.
    rotations : (o, 3, 3), translations : (o, 3)
        World-from-mesh pose of each object.
    centres, centre_velocities : (o, 3)
        Centre of gravity of each object and its velocity, world frame [m, m/s].
    positions, velocities : (h, 3), futures, future_velocities : (h, f, 3)
        Hands, their predicted points and velocities, world frame [m, m/s].
    pattern : (r, 2)
        Rays of a cone on the unit disc; the first is the axis.
    cone : (5,)
        Slow speed, its half-angle, fast speed, its half-angle, least speed for a cone.
    hits : (h, o) int64, written
        Number of rays that meet the mesh; objects do not hide one another.
    distances : (5, h, o), written
        To the nearest vertex and surface point from the hand, then both from the barycentre of its
        predicted points, then from the hand to the centre of gravity [m].
    centre_rates : (h, o), written
        Time derivative of that last distance [m/s].
    axial : (h, o), written
        z of the hand in the object frame [m].
    counters : (3,) int64, added to
        Tree nodes visited by rays and by nearest-point queries, and rays cast.
    """
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    p, v, d = np.empty(3), np.empty(3), np.empty(3)
    frame = np.empty((3, 3))
    barycentre = np.empty(3)
    points = futures.shape[1]
    tangents = np.empty(points)
    for h in range(positions.shape[0]):
        for k in range(points):
            speed = np.sqrt(
                future_velocities[h, k, 0] ** 2
                + future_velocities[h, k, 1] ** 2
                + future_velocities[h, k, 2] ** 2
            )
            drawn = speed >= cone[LEAST] and speed > 0.0
            tangents[k] = cone_tangent(speed, cone) if drawn else -1.0
        for axis in range(3):
            total = 0.0
            for k in range(points):
                total += futures[h, k, axis]
            barycentre[axis] = total / points
        for o in range(models.shape[0]):
            model = models[o]
            node0, triangle0 = starts[model, 0], starts[model, 1]
            sphere = spheres[model]
            _to_mesh(rotations[o], translations[o], positions[h], p)
            vertex, surface, x, y, z, vx, vy, vz = nearest(
                boxes, links, triangles, node0, triangle0, p[0], p[1], p[2], True,
                np.inf, np.inf, stack, near_stack, counters,
            )  # fmt: skip
            distances[0, h, o], distances[1, h, o] = vertex, surface
            along = 0.0
            away2 = 0.0
            rate = 0.0
            for axis in range(3):
                along += (p[axis] - origins[model, axis]) * axes[model, axis, 2]
                away = positions[h, axis] - centres[o, axis]
                away2 += away * away
                rate += away * (velocities[h, axis] - centre_velocities[o, axis])
            axial[h, o] = along
            distances[4, h, o] = np.sqrt(away2)
            centre_rates[h, o] = rate / max(distances[4, h, o], 1e-9)
            # what is nearest to the hand bounds what is nearest to the point ahead of it
            _to_mesh(rotations[o], translations[o], barycentre, p)
            vertex, surface, x, y, z, vx, vy, vz = nearest(
                boxes, links, triangles, node0, triangle0, p[0], p[1], p[2], True,
                _distance2(p, vx, vy, vz), _distance2(p, x, y, z), stack, near_stack, counters,
            )  # fmt: skip
            distances[2, h, o], distances[3, h, o] = vertex, surface
            met = 0
            for k in range(points):
                if tangents[k] < 0.0:
                    continue
                counters[RAYS] += pattern.shape[0]
                _turn_to_mesh(rotations[o], future_velocities[h, k], v)
                _to_mesh(rotations[o], translations[o], futures[h, k], p)
                if not cone_can_meet(v, tangents[k], p, sphere):
                    continue
                cone_frame(p, v, sphere, axes[model], frame)
                ahead = aside = across = distance2 = 0.0
                for axis in range(3):
                    away = sphere[axis] - p[axis]
                    ahead += frame[0, axis] * away
                    aside += frame[1, axis] * away
                    across += frame[2, axis] * away
                    distance2 += away * away
                gap2 = distance2 - sphere[3] * sphere[3]
                for ray in range(pattern.shape[0]):
                    a, b = tangents[k] * pattern[ray, 0], tangents[k] * pattern[ray, 1]
                    if not ray_can_meet(ahead, aside, across, gap2, a, b):
                        continue
                    ray_direction(frame, tangents[k], pattern, ray, d)
                    t = cast_ray(
                        boxes, links, triangles, node0, triangle0,
                        p[0], p[1], p[2], d[0], d[1], d[2], True, stack, counters,
                    )  # fmt: skip
                    if t < np.inf:
                        met += 1
            hits[h, o] = met


@kernel
def cone_impacts(
    boxes, links, triangles, start, sphere, axis, rotation, translation,
    future, future_velocity, pattern, cone, directions, lengths,
):  # fmt: skip
    """Cast the same rays as :func:`measure` for one pair and keep where they go, to be drawn.

    ``directions`` (f, r, 3), world frame, and ``lengths`` (f, r), infinity for a miss, are written;
    NaN directions mark points without a cone.
    """
    stack = np.empty(STACK, dtype=np.int32)
    counters = np.zeros(3, dtype=np.int64)
    p, v, d = np.empty(3), np.empty(3), np.empty(3)
    frame = np.empty((3, 3))
    for k in range(future.shape[0]):
        _turn_to_mesh(rotation, future_velocity[k], v)
        speed = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        if not speed >= cone[LEAST] or speed == 0.0:
            directions[k] = np.nan
            lengths[k] = np.inf
            continue
        _to_mesh(rotation, translation, future[k], p)
        tangent = cone_tangent(speed, cone)
        cone_frame(p, v, sphere, axis, frame)
        for ray in range(pattern.shape[0]):
            ray_direction(frame, tangent, pattern, ray, d)
            lengths[k, ray] = cast_ray(
                boxes, links, triangles, start[0], start[1],
                p[0], p[1], p[2], d[0], d[1], d[2], False, stack, counters,
            )  # fmt: skip
            for i in range(3):
                directions[k, ray, i] = (
                    rotation[i, 0] * d[0] + rotation[i, 1] * d[1] + rotation[i, 2] * d[2]
                )


@kernel
def approach(
    boxes, links, triangles, start, rotation, translation, coefficients, reach, limit, out
):
    """Find when a predicted path first comes within ``reach`` of the surface of one mesh.

    Conservative advancement: within a time h the path cannot lead further than
    ``|v| h + |c2| h²``, so a step that spends just the distance left is safe, and the first
    crossing is not stepped over.

    Parameters
    ----------
    boxes, links, triangles, start, rotation, translation
        The mesh and its pose, as for :func:`measure`.
    coefficients : (3, 3)
        Path c0 + c1 s + c2 s², world frame.
    reach, limit : float
        Distance [m] and latest time [s].
    out : (4,), written
        Time [s] (NaN: not before the limit) and the nearest surface point, mesh frame [m].
    """
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    counters = np.zeros(3, dtype=np.int64)
    world, p = np.empty(3), np.empty(3)
    bend = 0.0
    for axis in range(3):
        bend += coefficients[2, axis] ** 2
    bend = np.sqrt(bend)
    s = 0.0
    out[0] = np.nan
    for _ in range(100):
        speed = 0.0
        for axis in range(3):
            world[axis] = coefficients[0, axis] + s * (
                coefficients[1, axis] + s * coefficients[2, axis]
            )
            speed += (coefficients[1, axis] + 2.0 * s * coefficients[2, axis]) ** 2
        speed = np.sqrt(speed)
        _to_mesh(rotation, translation, world, p)
        _, surface, x, y, z, _, _, _ = nearest(
            boxes, links, triangles, start[0], start[1], p[0], p[1], p[2], False,
            np.inf, np.inf, stack, near_stack, counters,
        )  # fmt: skip
        if surface <= reach + 1e-4:
            out[0], out[1], out[2], out[3] = s, x, y, z
            return
        left = surface - reach
        # the positive root of |c2| h² + |v| h = left, in the form that loses no digits
        root = speed + np.sqrt(speed * speed + 4.0 * bend * left)
        if not root > 1e-9:
            return
        s += 2.0 * left / root
        if not s <= limit:
            return


@kernel
def spread(centres):
    """Return the largest distance between two points; NaN for fewer than two."""
    largest2 = np.nan
    for a in range(centres.shape[0]):
        for b in range(a):
            distance2 = 0.0
            for axis in range(3):
                distance2 += (centres[a, axis] - centres[b, axis]) ** 2
            if not distance2 <= largest2:
                largest2 = distance2
    return np.sqrt(largest2)
