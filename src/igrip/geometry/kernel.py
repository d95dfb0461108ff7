"""The measurements of a frame: every hand against every object, compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.geometry.cones import (
    cone_can_meet,
    cone_frame,
    cone_tangent,
    ray_can_meet,
    ray_direction,
    sphere_from,
)
from igrip.geometry.frame_arrays import Measurements
from igrip.geometry.object_frame import distance2, to_mesh, turn_to_mesh
from igrip.mesh.bvh import STACK
from igrip.mesh.nearest import nearest
from igrip.mesh.ray import cast_ray, meets_mesh

Array = NDArray[np.float64]
RAYS = 2  # counter of rays; the tree queries count their nodes in 0 and 1


class Scratch(NamedTuple):
    """Memory of :func:`_count_hits`, allocated once a call of :func:`measure`."""

    stack: NDArray[np.int32]
    apex: Array
    velocity: Array
    direction: Array
    frame: Array
    inner_spheres: Array


@kernel
def _mean(points, out):
    for axis in range(3):
        total = 0.0
        for k in range(points.shape[0]):
            total += points[k, axis]
        out[axis] = total / points.shape[0]


@kernel
def _count_hits(
    models, model, rotation, translation, future, future_velocity, tangents, cones, scratch,
    counters,
):  # fmt: skip
    """Count the rays of a hand's cones that meet one mesh.

    Parameters
    ----------
    models, model : ModelArrays, int
        The mesh.
    rotation, translation : (3, 3), (3,)
        World-from-mesh pose [m].
    future, future_velocity : (f, 3)
        Predicted points of the hand and their velocities, world frame [m, m/s].
    tangents : (f,)
        Of the half-angle of each point's cone; negative: no cone.
    cones : Cones
        The ray pattern.
    scratch : Scratch
        Overwritten.
    counters : (3,) int64, added to
        As for :func:`measure`.
    """
    stack, p, v, d, frame, placed = scratch
    bvh, pattern, sphere = models.bvh, cones.pattern, models.spheres[model]
    inner = models.inscribed_spheres[model]
    hits = 0
    for k in range(future.shape[0]):
        if tangents[k] < 0.0:
            continue
        counters[RAYS] += pattern.shape[0]
        turn_to_mesh(rotation, future_velocity[k], v)
        to_mesh(rotation, translation, future[k], p)
        if not cone_can_meet(v, tangents[k], p, sphere):
            continue
        cone_frame(p, v, sphere, models.axes[model], frame)
        ahead, aside, across, gap2 = sphere_from(frame, p, sphere)
        count = 0
        for n in range(inner.shape[0]):
            if inner[n, 3] <= 0.0:
                break
            placed[n, 0], placed[n, 1], placed[n, 2], placed[n, 3] = sphere_from(
                frame, p, inner[n]
            )
            count += 1
        for ray in range(pattern.shape[0]):
            a, b = tangents[k] * pattern[ray, 0], tangents[k] * pattern[ray, 1]
            if not ray_can_meet(ahead, aside, across, gap2, a, b):
                continue
            inside = False
            for n in range(count):
                inside = ray_can_meet(
                    placed[n, 0], placed[n, 1], placed[n, 2], placed[n, 3], a, b
                )
                if inside:
                    break
            if inside:
                hits += 1
                continue
            ray_direction(frame, tangents[k], pattern, ray, d)
            if meets_mesh(
                bvh.boxes, bvh.links, bvh.leaves, models.starts[model, 0], models.starts[model, 1],
                p[0], p[1], p[2], d[0], d[1], d[2], stack, counters,
            ):  # fmt: skip
                hits += 1
    return hits


@kernel
def measure(models, objects, hands, cones, counters):
    """Measure every hand against every object.

    Parameters
    ----------
    models : ModelArrays
        The meshes.
    objects : ObjectArrays
        Which mesh each object has, and where it is.
    hands : HandArrays
        The hands.
    cones : Cones
        Of rays from the predicted points.
    counters : (3,) int64, added to
        Tree nodes visited by rays and by nearest-point queries, and rays cast.

    Returns
    -------
    Measurements
        Of shape (h, o).
    """
    shape = (hands.positions.shape[0], objects.models.shape[0])
    out = Measurements(
        np.empty(shape, dtype=np.int64), np.empty(shape), np.empty(shape), np.empty(shape),
        np.empty(shape), np.empty(shape),
    )  # fmt: skip
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    p, barycentre = np.empty(3), np.empty(3)
    vertices, starts = models.vertices, models.starts
    positions, velocities = hands.positions, hands.velocities
    tangents = np.empty(hands.futures.shape[1])
    scratch = Scratch(
        stack, np.empty(3), np.empty(3), np.empty(3), np.empty((3, 3)),
        np.empty((models.inscribed_spheres.shape[1], 4)),
    )  # fmt: skip
    for h in range(shape[0]):
        for k in range(tangents.shape[0]):
            speed = np.sqrt(
                hands.future_velocities[h, k, 0] ** 2
                + hands.future_velocities[h, k, 1] ** 2
                + hands.future_velocities[h, k, 2] ** 2
            )
            has_cone = speed >= cones.min_speed and speed > 0.0
            tangents[k] = cone_tangent(speed, cones) if has_cone else -1.0
        _mean(hands.futures[h], barycentre)
        for o in range(shape[1]):
            model = objects.models[o]
            rotation, translation = objects.rotations[o], objects.translations[o]
            to_mesh(rotation, translation, positions[h], p)
            out.vertex[h, o], x, y, z = nearest(
                vertices.boxes, vertices.links, vertices.leaves, starts[model, 2], starts[model, 3],
                p[0], p[1], p[2], np.inf, stack, near_stack, counters,
            )  # fmt: skip
            along = 0.0
            away2 = 0.0
            rate = 0.0
            for axis in range(3):
                along += (p[axis] - models.origins[model, axis]) * models.axes[model, axis, 2]
                away = positions[h, axis] - objects.centres[o, axis]
                away2 += away * away
                rate += away * (velocities[h, axis] - objects.velocities[o, axis])
            out.axial[h, o] = along
            out.centre[h, o] = np.sqrt(away2)
            out.centre_rate[h, o] = rate / max(out.centre[h, o], 1e-9)
            # what is nearest to the hand bounds what is nearest to the point ahead of it
            to_mesh(rotation, translation, barycentre, p)
            out.future_vertex[h, o], _, _, _ = nearest(
                vertices.boxes, vertices.links, vertices.leaves, starts[model, 2], starts[model, 3],
                p[0], p[1], p[2], distance2(p, x, y, z), stack, near_stack, counters,
            )  # fmt: skip
            out.hits[h, o] = _count_hits(
                models, model, rotation, translation, hands.futures[h],
                hands.future_velocities[h], tangents, cones, scratch, counters,
            )  # fmt: skip
    return out


@kernel
def surfaces(models, objects, hands, counters):
    """Measure to the nearest surface points; the parameters are those of :func:`measure`.

    Returns
    -------
    (2, h, o)
        Distance from the hand, and from the barycentre of its predicted points [m].
    """
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    barycentre, p = np.empty(3), np.empty(3)
    bvh, starts = models.bvh, models.starts
    distances = np.empty((2, hands.positions.shape[0], objects.models.shape[0]))
    for h in range(distances.shape[1]):
        _mean(hands.futures[h], barycentre)
        for o in range(distances.shape[2]):
            model = objects.models[o]
            x = y = z = np.inf
            for ahead in range(2):
                point = barycentre if ahead else hands.positions[h]
                to_mesh(objects.rotations[o], objects.translations[o], point, p)
                distances[ahead, h, o], x, y, z = nearest(
                    bvh.boxes, bvh.links, bvh.leaves, starts[model, 0], starts[model, 1],
                    p[0], p[1], p[2], distance2(p, x, y, z), stack, near_stack, counters,
                )  # fmt: skip
    return distances


@kernel
def cone_impacts(models, model, rotation, translation, future, future_velocity, cones):
    """Cast the same rays as :func:`measure` for one pair and keep where they go, to be drawn.

    Parameters
    ----------
    models, model : ModelArrays, int
        The mesh.
    rotation, translation : (3, 3), (3,)
        World-from-mesh pose [m].
    future, future_velocity : (f, 3)
        Predicted points of the hand and their velocities, world frame [m, m/s].
    cones : Cones
        Of rays.

    Returns
    -------
    directions : (f, r, 3)
        World frame, not unit vectors; NaN where a point has no cone.
    lengths : (f, r)
        To the first impact in units of the direction; infinity for a miss.
    """
    stack = np.empty(STACK, dtype=np.int32)
    counters = np.zeros(3, dtype=np.int64)
    p, v, d = np.empty(3), np.empty(3), np.empty(3)
    frame = np.empty((3, 3))
    bvh, starts, pattern = models.bvh, models.starts, cones.pattern
    directions = np.empty((future.shape[0], pattern.shape[0], 3))
    lengths = np.empty((future.shape[0], pattern.shape[0]))
    for k in range(future.shape[0]):
        turn_to_mesh(rotation, future_velocity[k], v)
        speed = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        if not speed >= cones.min_speed or speed == 0.0:
            directions[k] = np.nan
            lengths[k] = np.inf
            continue
        to_mesh(rotation, translation, future[k], p)
        tangent = cone_tangent(speed, cones)
        cone_frame(p, v, models.spheres[model], models.axes[model], frame)
        for ray in range(pattern.shape[0]):
            ray_direction(frame, tangent, pattern, ray, d)
            lengths[k, ray] = cast_ray(
                bvh.boxes, bvh.links, bvh.leaves, starts[model, 0], starts[model, 1],
                p[0], p[1], p[2], d[0], d[1], d[2], stack, counters,
            )  # fmt: skip
            for i in range(3):
                directions[k, ray, i] = (
                    rotation[i, 0] * d[0] + rotation[i, 1] * d[1] + rotation[i, 2] * d[2]
                )
    return directions, lengths


@kernel
def spread(centres):
    """Return the largest distance between two points; NaN for fewer than two."""
    max2 = np.nan
    for a in range(centres.shape[0]):
        for b in range(a):
            gap2 = 0.0
            for axis in range(3):
                gap2 += (centres[a, axis] - centres[b, axis]) ** 2
            if not gap2 <= max2:
                max2 = gap2
    return np.sqrt(max2)
