"""Which axis points up in a scene on a table: the one along which everything is near one height."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MAX_HEIGHT = 0.15  # m between all that happens on a table
MIN_SPAN = 0.25  # m that the scene spans along the other axes
MIN_STEP = 0.05  # m between the heights of things that stand on different places


class Layer(NamedTuple):
    """A layer in which everything happens: across which axis, and what shows it."""

    axis: str
    text: str


def layer_of(hand: Array, objects: Sequence[Array]) -> Layer | None:
    """Return the layer of a scene where hand and objects stay at one height along y or x.

    Parameters
    ----------
    hand : (n, 3)
        Positions [m].
    objects : sequence of (3,)
        Places [m], at least two.
    """
    if len(objects) < 2 or not len(hand):
        return None
    places = np.array(objects)
    spans = np.ptp(np.vstack([hand, places]), axis=0)
    if spans[2] < MIN_SPAN or np.ptp(places[:, 2]) < MIN_STEP:
        return None
    for axis, name in ((1, "y"), (0, "x")):
        other = spans[1 - axis]
        if spans[axis] < MAX_HEIGHT and other > MIN_SPAN:
            return Layer(
                name,
                f"everything stays within {spans[axis]:.2f} m along {name} and spans "
                f"{spans[2]:.2f} m along z",
            )
    return None
