"""What the field's methods learned from the same people as ``bayes``, and the frame of a reach.

Their papers classify among a few fixed places. Here objects stand anywhere, so a movement is
described in the frame of each reach that it could be: its progress along the line from its start to
the object, and its deviation from that line, in lengths of the line.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import Geometry
from igrip.learned_weights import numbers, read_learned
from igrip.motion.trajectory import Motion
from igrip.targets.learned.features import LOCAL, features_of

Array = NDArray[np.float64]
LIBRARY = Path(__file__).with_name("reach_library.json")
FORMAT = "igrip-library/1"
PROGRESS, DEVIATION = LOCAL.index("progress"), LOCAL.index("deviation")


class ReachCoordinates(NamedTuple):
    """A moving hand in the frame of the reach to each object.

    Attributes
    ----------
    elapsed, passed : float
        Since the onset, and since the sample before [s].
    place : (o, 2)
        Progress and deviation, in lengths of the reach.
    length : (o,)
        From the start to the object [m].
    begins : bool
        Whether this is the first frame of a movement.
    """

    elapsed: float
    passed: float
    place: Array
    length: Array
    begins: bool = False


class ReachFrames:
    """Describes a hand in the frame of every reach that it could be doing."""

    def __init__(self) -> None:
        self._t = math.nan
        self._moved = False

    def update(self, motion: Motion, geometry: Geometry) -> ReachCoordinates | None:
        """Return the next frame's; None while the hand rests or there is nothing to reach."""
        reach = motion.reach
        elapsed = reach.elapsed
        passed = elapsed if math.isnan(self._t) else min(elapsed, motion.t - self._t)
        self._t = motion.t
        begins, self._moved = not self._moved, reach.moving
        if not reach.moving or not geometry.objects:
            return None
        cylinders = geometry.cylinders()
        local = features_of(reach, cylinders).local
        return ReachCoordinates(
            elapsed=elapsed,
            begins=begins,
            passed=passed,
            place=local[:, [PROGRESS, DEVIATION]],
            length=np.maximum(np.linalg.norm(cylinders.centre - reach.start, axis=1), 1e-3),
        )


def log_volume(reach: ReachCoordinates) -> Array:
    """Return the logarithm of the volume of a unit of progress and deviation, shape (o,).

    A point at progress and deviation d is a circle of radius ``d L`` round the line: densities over
    them become densities in space by ``2π d L³``. d counts as at least 0.01, so that the logarithm
    stays finite; the constant is left out.
    """
    volume: Array = 3.0 * np.log(reach.length) + np.log(np.maximum(reach.place[:, 1], 0.01))
    return volume


class AccumulatedLikelihood:
    """Log-likelihood of each object since the onset of the movement, by id.

    Samples count by the time they stand for, so that a faster sensor has no more weight.

    Parameters
    ----------
    step : float
        Time that a sample with the weight of one stands for [s].
    """

    def __init__(self, step: float) -> None:
        self._step = step
        self._total: dict[str, float] = {}
        self._elapsed = 0.0

    def add(self, geometry: Geometry, reach: ReachCoordinates, likelihood: Array) -> Array:
        """Add the log-likelihoods of a sample; return the probability of each object."""
        if reach.begins or reach.elapsed < self._elapsed:
            self._total = {}  # another movement
        self._elapsed = reach.elapsed
        lowest = min(self._total.values(), default=0.0)  # of objects that appear on the way
        steps = reach.passed / self._step
        self._total = {
            placed.id: self._total.get(placed.id, lowest) + steps * float(value)
            for placed, value in zip(geometry.objects, likelihood, strict=True)
        }
        return self.probability(geometry)

    def probability(self, geometry: Geometry) -> Array:
        """Return the probability of each object, shape (o,); zeros before the first sample.

        A hand that has stopped keeps those of its movement until the next one.
        """
        if not self._total:
            return np.zeros(len(geometry.objects))
        lowest = min(self._total.values())
        total = np.array([self._total.get(placed.id, lowest) for placed in geometry.objects])
        likelihood = np.exp(total - total.max(initial=-np.inf))
        probability: Array = likelihood / likelihood.sum()
        return probability


@cache
def library() -> dict[str, Any]:
    """Return the content of the file.

    Raises
    ------
    IgripError
        If the file is not of this format.
    """
    return read_learned(LIBRARY, FORMAT)


def library_array(*keys: str, shape: tuple[int, ...]) -> Array:
    """Return an array of the library; see :func:`igrip.learned_weights.numbers`."""
    return numbers(library(), keys, shape, LIBRARY)
