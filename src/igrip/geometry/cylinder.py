"""Bounding cylinders of a frame's objects, in the world."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

Array = NDArray[np.float64]


# columns, used in this file alone
CENTRE, AXIS, HALF_LENGTH, RADIUS, VELOCITY, WIDTH = 0, 3, 6, 7, 8, 11


class Cylinders(NamedTuple):
    """The cylinders of a frame's objects, in the order of the objects. World frame.

    Attributes
    ----------
    rows : (o, 11)
        As this file lays them out, read by the properties, and in kernels by :func:`centre_of` etc.
    paths : mapping of int to (n, 4)
        Rows t, x, y, z [s, m] of a point of each object that moves, by the object's number.
    """

    rows: Array
    paths: Mapping[int, Array] = MappingProxyType({})

    @classmethod
    def zeros(cls, count: int) -> Cylinders:
        """Return ``count`` cylinders, to be placed."""
        return cls(np.zeros((count, WIDTH)))

    @classmethod
    def of(
        cls, centre: Array, axis: Array, half_length: Array, radius: Array, velocity: Array
    ) -> Cylinders:
        """Return the cylinders with these properties."""
        return cls(np.column_stack([centre, axis, half_length, radius, velocity]))

    @property
    def centre(self) -> Array:
        """Mid-points, shape (o, 3) [m]."""
        return self.rows[:, CENTRE : CENTRE + 3]

    @property
    def axis(self) -> Array:
        """Unit axes, shape (o, 3)."""
        return self.rows[:, AXIS : AXIS + 3]

    @property
    def half_length(self) -> Array:
        """Half the lengths, shape (o,) [m]."""
        return self.rows[:, HALF_LENGTH]

    @property
    def radius(self) -> Array:
        """Radii, shape (o,) [m]."""
        return self.rows[:, RADIUS]

    @property
    def velocity(self) -> Array:
        """Velocities of the objects, shape (o, 3) [m/s]."""
        return self.rows[:, VELOCITY : VELOCITY + 3]

    def one(self, o: int) -> Cylinders:
        """Return cylinder ``o`` alone."""
        return Cylinders(self.rows[o : o + 1], {0: self.paths[o]} if o in self.paths else {})

    def distance(self, o: int, point: Array) -> float:
        """Return how far a point, shape (3,), is outside of cylinder ``o``; 0 inside [m]."""
        return float(distance_from(self.rows[o], point))


@kernel
def centre_of(row):
    """Return the mid-point of one cylinder, shape (3,) [m]; a view."""
    return row[CENTRE : CENTRE + 3]


@kernel
def axis_of(row):
    """Return the unit axis of one cylinder, shape (3,); a view."""
    return row[AXIS : AXIS + 3]


@kernel
def size_of(row):
    """Return half-length and radius of one cylinder [m]."""
    return row[HALF_LENGTH], row[RADIUS]


@kernel
def velocity_of(row):
    """Return the velocity of one cylinder, shape (3,) [m/s]; a view."""
    return row[VELOCITY : VELOCITY + 3]


@kernel
def distance_from(row, point):
    """Return how far a point, shape (3,), is outside of one cylinder; 0 inside [m]."""
    along = across2 = 0.0
    for axis in range(3):
        along += (point[axis] - row[CENTRE + axis]) * row[AXIS + axis]
    for axis in range(3):
        off = point[axis] - row[CENTRE + axis] - along * row[AXIS + axis]
        across2 += off * off
    beyond = max(abs(along) - row[HALF_LENGTH], 0.0)
    outside = max(np.sqrt(across2) - row[RADIUS], 0.0)
    return np.sqrt(beyond * beyond + outside * outside)


@kernel
def place_cylinders(models, axes, origins, sizes, rotations, translations, velocities, out):
    """Write the cylinder of each object.

    Parameters
    ----------
    models : (o,) int64
        Which mesh each object has.
    axes : (m, 3, 3), origins : (m, 3)
        Object axes by columns and mid-point of the cylinder, in the frame of the mesh.
    sizes : (m, 2)
        Half-length and radius [m].
    rotations : (o, 3, 3), translations : (o, 3), velocities : (o, 3)
        World-from-mesh pose of each object [m], and its velocity [m/s].
    out : (o, 11), written
        The rows of :class:`Cylinders`.
    """
    for o in range(models.shape[0]):
        mesh = models[o]
        for row in range(3):
            middle, axis = translations[o, row], 0.0
            for column in range(3):
                middle += rotations[o, row, column] * origins[mesh, column]
                axis += rotations[o, row, column] * axes[mesh, column, 2]
            out[o, CENTRE + row] = middle
            out[o, AXIS + row] = axis
            out[o, VELOCITY + row] = velocities[o, row]
        out[o, HALF_LENGTH] = sizes[mesh, 0]
        out[o, RADIUS] = sizes[mesh, 1]
