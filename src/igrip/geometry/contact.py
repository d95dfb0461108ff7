"""Time at which a predicted path comes within grasping distance of a mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.entities import Vector
from igrip.geometry.object_frame import distance, distance2, to_mesh
from igrip.geometry.packed_models import ModelArrays
from igrip.mesh.bvh import STACK
from igrip.mesh.nearest import nearest

Array = NDArray[np.float64]
MAX_STEPS = 400  # a path is followed in steps of at least this part of the horizon
TOLERANCE = 1e-4  # m; of the distance at contact
SPHERE_MARGIN = 0.05  # m; further than this from a bounding sphere the sphere stands for the mesh


def approach(
    models: ModelArrays, model: int, rotation: Array, translation: Array, coefficients: Array,
    reach: float, horizon: float,
) -> tuple[float, Vector]:  # fmt: skip
    """Find when a predicted path first comes within ``reach`` of the surface of one mesh.

    Conservative advancement: within a time h the path cannot lead further than
    ``|v| h + |c2| h²``, so a step that spends just the distance left is safe, and the first
    crossing is not stepped over.

    Parameters
    ----------
    models, model : ModelArrays, int
        The mesh.
    rotation, translation : (3, 3), (3,)
        World-from-mesh pose [m].
    coefficients : (3, 3)
        Path c0 + c1 s + c2 s², world frame.
    reach, horizon : float
        Distance [m] and latest time [s].

    Returns
    -------
    time : float
        [s]; NaN if not before the horizon.
    point : 3 floats
        The nearest surface point then, world frame [m].
    """
    found: tuple[float, Vector] = _approach(
        models.boxes, models.links, models.triangles, models.starts[model], models.spheres[model],
        rotation, translation, coefficients, reach, horizon,
    )  # fmt: skip
    return found


@kernel
def _approach(
    boxes, links, triangles, start, sphere, rotation, translation, coefficients, reach, horizon
):  # fmt: skip
    """Return the result of :func:`approach`."""
    never = (np.nan, (np.nan, np.nan, np.nan))
    stack = np.empty(STACK, dtype=np.int32)
    near_stack = np.empty(STACK)
    counters = np.zeros(3, dtype=np.int64)
    world, p = np.empty(3), np.empty(3)
    bend = 0.0
    for axis in range(3):
        bend += coefficients[2, axis] ** 2
    bend = np.sqrt(bend)
    s = 0.0
    x = y = z = np.inf
    min_step = horizon / MAX_STEPS
    outside, inside = 0.0, np.inf  # between these times the border is crossed
    while True:
        speed = 0.0
        for axis in range(3):
            world[axis] = coefficients[0, axis] + s * (
                coefficients[1, axis] + s * coefficients[2, axis]
            )
            speed += (coefficients[1, axis] + 2.0 * s * coefficients[2, axis]) ** 2
        speed = np.sqrt(speed)
        to_mesh(rotation, translation, world, p)
        # far away the gap to the sphere is nearly as long as that to the mesh, and costs no search
        left = distance(p, sphere) - sphere[3] - reach
        if left < SPHERE_MARGIN:
            # what was nearest a step ago bounds what is nearest now
            surface, x, y, z = nearest(
                boxes, links, triangles, start[0], start[1],
                p[0], p[1], p[2], distance2(p, x, y, z), stack, near_stack, counters,
            )  # fmt: skip
            left = surface - reach
        if left <= TOLERANCE:
            inside = s
            if left >= 0.0 or inside - outside <= 1e-3 * min_step:
                for axis in range(3):
                    world[axis] = (
                        rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2] * z
                        + translation[axis]
                    )  # fmt: skip
                return s, (world[0], world[1], world[2])
        else:
            outside = s
        if inside < np.inf:  # a minimal step led too far in: back to the border
            s = 0.5 * (outside + inside)
            continue
        # the positive root of |c2| h² + |v| h = left, in the form that loses no digits
        root = speed + np.sqrt(speed * speed + 4.0 * bend * left)
        if not root > 1e-9:
            return never
        # a shallow approach would creep, each step a part of the last
        s += max(2.0 * left / root, min_step)
        if not s <= horizon:
            return never
