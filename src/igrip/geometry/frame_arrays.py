"""Hands and objects of a frame as the kernels read them, and what they measure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ObjectArrays(NamedTuple):
    """The objects of a frame.

    Attributes
    ----------
    models : (o,) int64
        Number of the mesh of each, in a :class:`igrip.geometry.packed_models.ModelArrays`.
    rotations, translations : (o, 3, 3), (o, 3)
        World-from-mesh poses [m].
    centres, velocities : (o, 3)
        Centres of gravity and their velocities, world frame [m, m/s].
    """

    models: NDArray[np.int64]
    rotations: Array
    translations: Array
    centres: Array
    velocities: Array


class HandArrays(NamedTuple):
    """The hands of a frame, world frame.

    Attributes
    ----------
    positions, velocities : (h, 3)
        Of each hand [m, m/s].
    futures, future_velocities : (h, f, 3)
        Its predicted points and their velocities [m, m/s].
    """

    positions: Array
    velocities: Array
    futures: Array
    future_velocities: Array


class Measurements(NamedTuple):
    """Every hand against every object; each of shape (h, o).

    Attributes
    ----------
    hits : int64
        Rays that meet the mesh; objects do not hide one another.
    vertex, future_vertex : float64
        Distance to the nearest vertex, from the hand and from the barycentre of its predicted
        points [m].
    centre, centre_rate : float64
        Distance from the hand to the centre of gravity and its time derivative [m, m/s].
    axial : float64
        z of the hand in the object frame [m].
    """

    hits: NDArray[np.int64]
    vertex: Array
    future_vertex: Array
    centre: Array
    centre_rate: Array
    axial: Array

    @classmethod
    def empty(cls, hands: int, objects: int) -> Measurements:
        """Return arrays of this shape, for a kernel to write to."""
        hits = np.empty((hands, objects), dtype=np.int64)
        return cls(hits, *np.empty((len(cls._fields) - 1, hands, objects)))
