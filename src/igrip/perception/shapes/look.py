"""How a thing looks, in any pose: its size and its colour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from igrip.rgbd import Array

SAME_SIZE = 0.15  # of each edge, by which views of one thing differ; guess
MIN_EDGE = 0.012  # by which they may differ in any case [m]; guess
SAME_COLOUR = 0.09  # distance of (r, g) over r + g + b; guess
SAME_BRIGHTNESS = 2.0  # ratio; light changes


@dataclass(frozen=True, eq=False)
class Look:
    """Size and colour of a thing, in any pose.

    ``size`` holds the edges of its bounding box, longest first, (3,) [m]; ``colour`` is the median
    of red, green and blue, (3,) 0 to 255.
    """

    size: Array
    colour: Array

    def is_like(self, other: Look) -> bool:
        """Return whether both may be looks of one thing."""
        allowed = np.maximum(SAME_SIZE * np.maximum(self.size, other.size), MIN_EDGE)
        if (np.abs(self.size - other.size) > allowed).any():
            return False
        a, b = float(self.colour.sum()) + 1.0, float(other.colour.sum()) + 1.0
        tint = np.linalg.norm(self.colour[:2] / a - other.colour[:2] / b)
        return bool(tint < SAME_COLOUR and max(a, b) < SAME_BRIGHTNESS * min(a, b))


def look_of(vertices: Array, colours: NDArray[np.uint8]) -> Look:
    """Return the look of a thing with vertices (v, 3) [m] and pixels (n, 3)."""
    size = np.sort(np.ptp(vertices, axis=0))[::-1].copy()
    middle = np.median(colours.reshape(-1, 3), axis=0) if len(colours) else np.zeros(3)
    return Look(size, np.asarray(middle, dtype=np.float64))
