"""The rays of one hand and one object again, to be drawn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.geometry.cones import Cones, cone_frame, cone_tangent, ray_direction
from igrip.geometry.object_frame import to_mesh, turn_to_mesh
from igrip.geometry.packed_models import ModelArrays
from igrip.mesh.bvh import STACK
from igrip.mesh.ray import cast_ray

Array = NDArray[np.float64]


@kernel
def cone_impacts(
    models: ModelArrays, model: int, rotation: Array, translation: Array, future: Array,
    future_velocity: Array, cones: Cones,
) -> tuple[Array, Array]:  # fmt: skip
    """Cast the same rays as :func:`igrip.geometry.kernel.measure` and keep where they go.

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
    starts, pattern = models.starts, cones.pattern
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
        tangent = cone_tangent(
            speed, cones.slow_speed, cones.slow_angle, cones.fast_speed, cones.fast_angle
        )
        cone_frame(p, v, models.spheres[model], models.axes[model], frame)
        for ray in range(pattern.shape[0]):
            ray_direction(frame, tangent, pattern, ray, d)
            lengths[k, ray] = cast_ray(
                models.boxes, models.links, models.triangles, starts[model, 0], starts[model, 1],
                p[0], p[1], p[2], d[0], d[1], d[2], stack, counters,
            )  # fmt: skip
            for i in range(3):
                directions[k, ray, i] = (
                    rotation[i, 0] * d[0] + rotation[i, 1] * d[1] + rotation[i, 2] * d[2]
                )
    return directions, lengths
