"""The measurements of a frame: every hand against every object, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.geometry.cones import (
    Cones,
    cone_can_meet,
    cone_frame,
    cone_tangent,
    ray_can_meet,
    ray_direction,
    sphere_from,
)
from igrip.geometry.frame_arrays import HandArrays, Measurements, ObjectArrays
from igrip.geometry.object_frame import distance2, to_mesh, turn_to_mesh
from igrip.geometry.packed_models import ModelArrays
from igrip.mesh.bvh import STACK
from igrip.mesh.nearest import nearest
from igrip.mesh.ray import meets_mesh

Array = NDArray[np.float64]
Counters = NDArray[np.int64]
RAYS = 2  # counter of rays; the tree queries count their nodes in 0 and 1


@kernel
def _mean(points, out):
    for axis in range(3):
        total = 0.0
        for k in range(points.shape[0]):
            total += points[k, axis]
        out[axis] = total / points.shape[0]


def measure(
    models: ModelArrays, objects: ObjectArrays, hands: HandArrays, cones: Cones, counters: Counters
) -> Measurements:
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
    """
    out = Measurements.empty(len(hands.positions), len(objects.models))
    _measure(*models, *objects, *hands, *cones, *out, counters)
    return out


@kernel
def _measure(
    boxes, links, triangles, vertex_boxes, vertex_links, vertices, starts, spheres,
    inscribed_spheres, axes, origins, sizes,
    models, rotations, translations, centres, centre_velocities,
    positions, velocities, futures, future_velocities,
    pattern, slow_speed, slow_angle, fast_speed, fast_angle, min_speed,
    hits, vertex, future_vertex, centre, centre_rate, axial, counters,
):  # fmt: skip
    """Write the result of :func:`measure`.

    The parameters are the fields of its parameters, in order: numba reads arrays from Python, and
    passes them on, much faster than named tuples.
    """
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    p, v, d = np.empty(3), np.empty(3), np.empty(3)
    frame = np.empty((3, 3))
    barycentre = np.empty(3)
    points = futures.shape[1]
    tangents = np.empty(points)
    inner = np.empty((inscribed_spheres.shape[1], 4))
    for h in range(positions.shape[0]):
        for k in range(points):
            speed = np.sqrt(
                future_velocities[h, k, 0] ** 2
                + future_velocities[h, k, 1] ** 2
                + future_velocities[h, k, 2] ** 2
            )
            tangents[k] = -1.0
            if speed >= min_speed and speed > 0.0:
                tangents[k] = cone_tangent(speed, slow_speed, slow_angle, fast_speed, fast_angle)
        _mean(futures[h], barycentre)
        for o in range(models.shape[0]):
            model = models[o]
            sphere = spheres[model]
            to_mesh(rotations[o], translations[o], positions[h], p)
            vertex[h, o], x, y, z = nearest(
                vertex_boxes, vertex_links, vertices, starts[model, 2], starts[model, 3],
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
            centre[h, o] = np.sqrt(away2)
            centre_rate[h, o] = rate / max(centre[h, o], 1e-9)
            # what is nearest to the hand bounds what is nearest to the point ahead of it
            to_mesh(rotations[o], translations[o], barycentre, p)
            future_vertex[h, o], _, _, _ = nearest(
                vertex_boxes, vertex_links, vertices, starts[model, 2], starts[model, 3],
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
                for n in range(inscribed_spheres.shape[1]):
                    if inscribed_spheres[model, n, 3] <= 0.0:
                        break
                    inner[n, 0], inner[n, 1], inner[n, 2], inner[n, 3] = sphere_from(
                        frame, p, inscribed_spheres[model, n]
                    )
                    count += 1
                for ray in range(pattern.shape[0]):
                    a, b = tangents[k] * pattern[ray, 0], tangents[k] * pattern[ray, 1]
                    if not ray_can_meet(ahead, aside, across, gap2, a, b):
                        continue
                    inside = False
                    for n in range(count):
                        inside = ray_can_meet(
                            inner[n, 0], inner[n, 1], inner[n, 2], inner[n, 3], a, b
                        )
                        if inside:
                            break
                    if inside:
                        met += 1
                        continue
                    ray_direction(frame, tangents[k], pattern, ray, d)
                    if meets_mesh(
                        boxes, links, triangles, starts[model, 0], starts[model, 1],
                        p[0], p[1], p[2], d[0], d[1], d[2], stack, counters,
                    ):  # fmt: skip
                        met += 1
            hits[h, o] = met


def surfaces(
    models: ModelArrays, objects: ObjectArrays, hands: HandArrays, counters: Counters
) -> Array:
    """Measure to the nearest surface points; the parameters are those of :func:`measure`.

    Returns
    -------
    (2, h, o)
        Distance from the hand, and from the barycentre of its predicted points [m].
    """
    distances = np.empty((2, len(hands.positions), len(objects.models)))
    _surfaces(
        models.boxes, models.links, models.triangles, models.starts,
        objects.models, objects.rotations, objects.translations,
        hands.positions, hands.futures, distances, counters,
    )  # fmt: skip
    return distances


@kernel
def _surfaces(
    boxes, links, triangles, starts, models, rotations, translations, positions, futures,
    distances, counters,
):  # fmt: skip
    """Write the distances of :func:`surfaces`."""
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
                    boxes, links, triangles, starts[models[o], 0], starts[models[o], 1],
                    p[0], p[1], p[2], distance2(p, x, y, z), stack, near_stack, counters,
                )  # fmt: skip


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
