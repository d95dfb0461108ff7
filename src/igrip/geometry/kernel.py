"""The measurements of a frame: every hand against every object, compiled."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.geometry.cones import (
    LEAST,
    cone_can_meet,
    cone_frame,
    cone_tangent,
    ray_can_meet,
    ray_direction,
    sphere_from,
)
from igrip.geometry.object_frame import distance2, to_mesh, turn_to_mesh
from igrip.mesh.bvh import STACK
from igrip.mesh.nearest import nearest
from igrip.mesh.ray import cast_ray, meets_mesh

RAY_NODES, POINT_NODES, RAYS = 0, 1, 2  # counters


@kernel
def _mean(points, out):
    for axis in range(3):
        total = 0.0
        for k in range(points.shape[0]):
            total += points[k, axis]
        out[axis] = total / points.shape[0]


@kernel
def measure(
    bvh, vertices, starts, spheres, balls, axes, origins, models, rotations, translations,
    centres, centre_velocities, positions, velocities, futures, future_velocities, pattern, cone,
    hits, distances, centre_rates, axial, counters,
):  # fmt: skip
    """Measure every hand against every object.

    Parameters
    ----------
    bvh, vertices : Bvh
        Trees of the triangles and of the vertices of all meshes, one after the other.
    starts : (m, 4) int64
        First node and first triangle, first node and first vertex of each mesh.
    balls : (m, b, 4)
        Balls inside each mesh, centre and radius, in its frame; a negative radius: none.
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
    distances : (3, h, o), written
        To the nearest vertex from the hand and from the barycentre of its predicted points, then
        from the hand to the centre of gravity [m].
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
    seen = np.empty((balls.shape[1], 4))
    for h in range(positions.shape[0]):
        for k in range(points):
            speed = np.sqrt(
                future_velocities[h, k, 0] ** 2
                + future_velocities[h, k, 1] ** 2
                + future_velocities[h, k, 2] ** 2
            )
            drawn = speed >= cone[LEAST] and speed > 0.0
            tangents[k] = cone_tangent(speed, cone) if drawn else -1.0
        _mean(futures[h], barycentre)
        for o in range(models.shape[0]):
            model = models[o]
            sphere = spheres[model]
            to_mesh(rotations[o], translations[o], positions[h], p)
            distances[0, h, o], x, y, z = nearest(
                vertices.boxes, vertices.links, vertices.leaves, starts[model, 2], starts[model, 3],
                p[0], p[1], p[2], np.inf, stack, near_stack, counters,
            )  # fmt: skip
            along = 0.0
            away2 = 0.0
            rate = 0.0
            for axis in range(3):
                along += (p[axis] - origins[model, axis]) * axes[model, axis, 2]
                away = positions[h, axis] - centres[o, axis]
                away2 += away * away
                rate += away * (velocities[h, axis] - centre_velocities[o, axis])
            axial[h, o] = along
            distances[2, h, o] = np.sqrt(away2)
            centre_rates[h, o] = rate / max(distances[2, h, o], 1e-9)
            # what is nearest to the hand bounds what is nearest to the point ahead of it
            to_mesh(rotations[o], translations[o], barycentre, p)
            distances[1, h, o], _, _, _ = nearest(
                vertices.boxes, vertices.links, vertices.leaves, starts[model, 2], starts[model, 3],
                p[0], p[1], p[2], distance2(p, x, y, z), stack, near_stack, counters,
            )  # fmt: skip
            met = 0
            for k in range(points):
                if tangents[k] < 0.0:
                    continue
                counters[RAYS] += pattern.shape[0]
                turn_to_mesh(rotations[o], future_velocities[h, k], v)
                to_mesh(rotations[o], translations[o], futures[h, k], p)
                if not cone_can_meet(v, tangents[k], p, sphere):
                    continue
                cone_frame(p, v, sphere, axes[model], frame)
                ahead, aside, across, gap2 = sphere_from(frame, p, sphere)
                count = 0
                for n in range(balls.shape[1]):
                    if balls[model, n, 3] <= 0.0:
                        break
                    seen[n, 0], seen[n, 1], seen[n, 2], seen[n, 3] = sphere_from(
                        frame, p, balls[model, n]
                    )
                    count += 1
                for ray in range(pattern.shape[0]):
                    a, b = tangents[k] * pattern[ray, 0], tangents[k] * pattern[ray, 1]
                    if not ray_can_meet(ahead, aside, across, gap2, a, b):
                        continue
                    inside = False
                    for n in range(count):
                        inside = ray_can_meet(seen[n, 0], seen[n, 1], seen[n, 2], seen[n, 3], a, b)
                        if inside:
                            break
                    if inside:
                        met += 1
                        continue
                    ray_direction(frame, tangents[k], pattern, ray, d)
                    if meets_mesh(
                        bvh.boxes, bvh.links, bvh.leaves, starts[model, 0], starts[model, 1],
                        p[0], p[1], p[2], d[0], d[1], d[2], stack, counters,
                    ):  # fmt: skip
                        met += 1
            hits[h, o] = met


@kernel
def surfaces(
    bvh, starts, models, rotations, translations, positions, futures, distances, counters
):  # fmt: skip
    """Measure to the nearest surface points; the parameters are those of :func:`measure`.

    ``distances`` (2, h, o) is written: from the hand, and from the barycentre of its predicted
    points [m].
    """
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    barycentre, p = np.empty(3), np.empty(3)
    for h in range(positions.shape[0]):
        _mean(futures[h], barycentre)
        for o in range(models.shape[0]):
            x = y = z = np.inf
            for ahead in range(2):
                point = barycentre if ahead else positions[h]
                to_mesh(rotations[o], translations[o], point, p)
                distances[ahead, h, o], x, y, z = nearest(
                    bvh.boxes, bvh.links, bvh.leaves, starts[models[o], 0], starts[models[o], 1],
                    p[0], p[1], p[2], distance2(p, x, y, z), stack, near_stack, counters,
                )  # fmt: skip


@kernel
def cone_impacts(
    bvh, start, sphere, axis, rotation, translation,
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
        turn_to_mesh(rotation, future_velocity[k], v)
        speed = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        if not speed >= cone[LEAST] or speed == 0.0:
            directions[k] = np.nan
            lengths[k] = np.inf
            continue
        to_mesh(rotation, translation, future[k], p)
        tangent = cone_tangent(speed, cone)
        cone_frame(p, v, sphere, axis, frame)
        for ray in range(pattern.shape[0]):
            ray_direction(frame, tangent, pattern, ray, d)
            lengths[k, ray] = cast_ray(
                bvh.boxes, bvh.links, bvh.leaves, start[0], start[1],
                p[0], p[1], p[2], d[0], d[1], d[2], stack, counters,
            )  # fmt: skip
            for i in range(3):
                directions[k, ray, i] = (
                    rotation[i, 0] * d[0] + rotation[i, 1] * d[1] + rotation[i, 2] * d[2]
                )


@kernel
def spread(centres):
    """Return the largest distance between two points; NaN for fewer than two."""
    largest2 = np.nan
    for a in range(centres.shape[0]):
        for b in range(a):
            apart2 = 0.0
            for axis in range(3):
                apart2 += (centres[a, axis] - centres[b, axis]) ** 2
            if not apart2 <= largest2:
                largest2 = apart2
    return np.sqrt(largest2)
