"""Familiarity: how like the real reaches that were learned from a movement is.

The distance of a movement's features from those of real reaches (Mahalanobis) is compared with the
distances of the real reaches themselves: their share that lies further out is the conformal p-value
of the hypothesis that the movement is one of them (Vovk, Gammerman & Shafer 2005). It is uniform
between 0 and 1 for movements like those learned from, and near 0 for strange ones.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.errors import IgripError
from igrip.learned_weights import numbers, read_learned
from igrip.targets.learned.features import SHARED

Array = NDArray[np.float64]
FORMAT = "igrip-familiarity/1"
FILE = Path(__file__).with_name("familiarity.json")
USED = tuple(name for name in SHARED if name != "noise_of_way")
"""Features of the movement that are compared: all but the noise, which is the sensor's."""
COLUMNS = np.array([SHARED.index(name) for name in USED])
TIME_CONSTANT = 0.2  # s; memory of the mean over a movement; guess


@kernel
def _p_value(shared, columns, centre, precision, distances):
    """Return the result of :meth:`FamiliarMovements.p_value`."""
    total = 0.0
    for i in range(len(columns)):
        row = 0.0
        for j in range(len(columns)):
            row += precision[i, j] * (shared[columns[j]] - centre[j])
        total += row * (shared[columns[i]] - centre[i])
    distance = math.sqrt(max(total, 0.0))
    above = np.searchsorted(distances, distance, side="right")
    if above == 0:
        return 1.0
    if above == len(distances):
        return 0.0
    part = (distance - distances[above - 1]) / (distances[above] - distances[above - 1])
    return 1.0 - (above - 1 + part) / (len(distances) - 1)


class FamiliarMovements(NamedTuple):
    """What real reaches look like.

    Attributes
    ----------
    centre : (k,), precision : (k, k)
        Median and inverse covariance of the features :data:`USED`.
    distances : (q,)
        Evenly spaced quantiles of the distances of the real reaches, increasing.
    """

    centre: Array
    precision: Array
    distances: Array

    def p_value(self, shared: Array) -> float:
        """Return the share of real frames that are further out than one with these features.

        Parameters
        ----------
        shared : (s,)
            As :class:`igrip.targets.learned.features.Features` has them.
        """
        p_value: float = _p_value(shared, COLUMNS, self.centre, self.precision, self.distances)
        return p_value


@cache
def default_movements() -> FamiliarMovements:
    """Return the description that ships."""
    return read_movements(FILE)


def read_movements(path: Path) -> FamiliarMovements:
    """Read a description of real reaches.

    Raises
    ------
    IgripError
        If the file is not of this format, or was made for other features.
    """
    content = read_learned(path, FORMAT)
    if tuple(content.get("features", ())) != USED:
        raise IgripError(f"{path}: was made for other features; retrain it (make train)")
    size = len(USED)
    return FamiliarMovements(
        numbers(content, ["centre"], (size,), path),
        numbers(content, ["precision"], (size, size), path),
        numbers(content, ["distances"], (-1,), path),
    )


class Familiarity:
    """The familiarity of one hand's movement: the running mean of its p-values.

    Parameters
    ----------
    movements : FamiliarMovements, optional
        By default those that ship.
    """

    def __init__(self, movements: FamiliarMovements | None = None) -> None:
        self._movements = movements or default_movements()
        self.reset()

    def reset(self) -> None:
        """Forget the movement: the next frame begins another."""
        self.value: float | None = None
        self._t = math.nan

    def update(self, t: float, shared: Array) -> float:
        """Return the familiarity after a frame at ``t`` [s], from 0 to 1."""
        p_value = self._movements.p_value(shared)
        if self.value is None:
            self.value = p_value
        else:
            weight = -math.expm1(-max(t - self._t, 0.0) / TIME_CONSTANT)
            self.value += weight * (p_value - self.value)
        self._t = t
        return self.value
