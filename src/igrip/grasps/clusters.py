"""A few of many hands that fit: those that most others are alike, one for each kind."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

Array = NDArray[np.float64]

NEAR, APART = 0.015, 0.05  # m; alike are centres nearer than the first, separate beyond the second
ANGLE, APART_ANGLE = np.radians(20.0), np.radians(50.0)
OPENING, APART_OPENING = 0.008, 0.015  # m


class Likeness:
    """How alike hands are, by centre, approach, closing direction (either way) and opening.

    Parameters
    ----------
    centre, approach, closing : (g, 3)
        In one frame [m].
    opening : (g,)
        [m]
    """

    def __init__(self, centre: Array, approach: Array, closing: Array, opening: Array) -> None:
        self._centre, self._approach, self._closing = centre, approach, closing
        self._opening = opening

    def to(self, k: int, near: float, angle: float, opening: float) -> NDArray[np.bool_]:
        """Return which hands are alike hand ``k`` within these tolerances, shape (g,)."""
        cos = float(np.cos(angle))
        alike: NDArray[np.bool_] = (
            (((self._centre - self._centre[k]) ** 2).sum(axis=1) < near**2)
            & (self._approach @ self._approach[k] > cos)
            & (np.abs(self._closing @ self._closing[k]) > cos)
            & (np.abs(self._opening - self._opening[k]) < opening)
        )
        return alike

    def support(self, weight: Array) -> Array:
        """Return the weight of all hands alike each, shape (g,)."""
        out = np.zeros(len(weight))
        _support(
            self._centre, self._approach, self._closing, self._opening, weight,
            NEAR, float(np.cos(ANGLE)), OPENING, out,
        )  # fmt: skip
        return out


@kernel
def _support(centre, approach, closing, opening, weight, near, cos, same, out):
    """Write the result of :meth:`Likeness.support`."""
    for i in range(weight.shape[0]):
        for j in range(weight.shape[0]):
            if abs(opening[i] - opening[j]) >= same:
                continue
            off = along = across = 0.0
            for axis in range(3):
                off += (centre[i, axis] - centre[j, axis]) ** 2
                along += approach[i, axis] * approach[j, axis]
                across += closing[i, axis] * closing[j, axis]
            if off < near * near and along > cos and abs(across) > cos:
                out[i] += weight[j]


def clusters(
    likeness: Likeness, weight: Array, least: float, share: float
) -> Iterator[tuple[int, NDArray[np.int64], NDArray[np.int64]]]:
    """Yield groups of hands that are alike, that of the greatest weight first.

    Parameters
    ----------
    likeness : Likeness
        Of the hands.
    weight : (g,)
        Of each.
    least, share : float
        Groups of a smaller weight, or a smaller share of that of the first, are left out.

    Yields
    ------
    middle : int
        The hand that the rest of the group is alike.
    members, near : (m,), (n,) int64
        The group, and all that are too near to it to lead another and belong to no earlier one.
    """
    support = likeness.support(weight)
    least = max(least, share * float(support.max(initial=0.0)))
    free = np.ones(len(weight), dtype=bool)
    while free.any():
        k = int(np.argmax(np.where(free, support, -1.0)))
        if support[k] < least:
            return
        members = likeness.to(k, NEAR, ANGLE, OPENING)
        near = likeness.to(k, APART, APART_ANGLE, APART_OPENING) & free
        yield k, np.flatnonzero(members), np.flatnonzero(near)
        free &= ~near
