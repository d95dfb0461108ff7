"""Cues: pure functions from the motion of a hand to a score of every object."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.registry import Registry
from igrip.settings import Settings, quantity

Scores = NDArray[np.float64]


class CueConfig(Settings):
    """Parameters of the cues."""

    distance: Literal["vertex", "surface"] = "vertex"  # the paper: vertex
    min_speed: float = quantity(
        0.03, "m/s", "the distance derivative of a slower hand scores 0", "guess", ge=0
    )
    default_spread: float = quantity(
        0.5, "m", "d_max if there is one object, or all are at one place", "guess", gt=0
    )

    def spread(self, geometry: Geometry) -> float:
        """Return d_max, the length that distances are compared with [m]."""
        # a NaN (fewer than two objects) fails the comparison as well
        return geometry.spread if geometry.spread > 1e-6 else self.default_spread


@dataclass(frozen=True, slots=True)
class Cue:
    """One cue.

    Attributes
    ----------
    name : str
        Its name in ``Intention.scores``.
    order : int
        0 if it looks at where the hand is or will be, 1 if at how it moves: the paper's weights
        w_0 and w_1 go by it.
    score : function
        ``(motion, geometry, config) → scores``, one per object, higher for a likelier target.
    """

    name: str
    order: Literal[0, 1]
    score: Callable[[Motion, Geometry, CueConfig], Scores]


CUES: Registry[Cue] = Registry("cue", "igrip.cues")


def cue(
    name: str, order: Literal[0, 1]
) -> Callable[[Callable[[Motion, Geometry, CueConfig], Scores]], Cue]:
    """Return a decorator that makes a function a cue and registers it."""

    def make(function: Callable[[Motion, Geometry, CueConfig], Scores]) -> Cue:
        return CUES.register(name)(Cue(name, order, function))

    return make
