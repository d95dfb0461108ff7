"""Bounding cylinders of a frame's objects, in the world."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

Array = NDArray[np.float64]


class Cylinders(NamedTuple):
    """The cylinders of a frame's objects, in the order of the objects. World frame.

    Attributes
    ----------
    centre : (o, 3)
        Mid-points [m].
    axis : (o, 3)
        Unit axes.
    half_length, radius : (o,)
        Sizes [m].
    velocity : (o, 3)
        Of the objects [m/s].
    """

    centre: Array
    axis: Array
    half_length: Array
    radius: Array
    velocity: Array


def new_cylinders(count: int) -> Cylinders:
    """Return zeros, for :func:`place_cylinders` to write to."""
    centre, axis, velocity = np.zeros((3, count, 3))
    half_length, radius = np.zeros((2, count))
    return Cylinders(centre, axis, half_length, radius, velocity)


@kernel
def place_cylinders(models, objects, out):
    """Write the cylinder of each object.

    Parameters
    ----------
    models : ModelArrays
        The meshes.
    objects : ObjectArrays
        Where they are.
    out : Cylinders, written
        World frame.
    """
    for o in range(objects.models.shape[0]):
        mesh = objects.models[o]
        for row in range(3):
            middle, axis = objects.translations[o, row], 0.0
            for column in range(3):
                middle += objects.rotations[o, row, column] * models.origins[mesh, column]
                axis += objects.rotations[o, row, column] * models.axes[mesh, column, 2]
            out.centre[o, row] = middle
            out.axis[o, row] = axis
            out.velocity[o, row] = objects.velocities[o, row]
        out.half_length[o] = models.half_lengths[mesh]
        out.radius[o] = models.radii[mesh]
