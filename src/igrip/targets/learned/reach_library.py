"""What the field's methods learned from the same people as ``bayes``, and how they see a reach.

Their papers classify among a few fixed places. Here objects stand anywhere, so a movement is seen
in the frame of each reach that it could be: how far it has come along the line from its start to
the object, and how far it is from that line, in lengths of the line.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.geometry import cylinder
from igrip.geometry.scene import Geometry
from igrip.learned_weights import numbers, read_learned
from igrip.motion.trajectory import Motion
from igrip.targets.learned.features import LOCAL, SHARED, describe

Array = NDArray[np.float64]
LIBRARY = Path(__file__).with_name("reach_library.json")
FORMAT = "igrip-library/1"
PROGRESS, DEVIATION = LOCAL.index("progress"), LOCAL.index("deviation")


class InReach(NamedTuple):
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
        Whether this is the first frame of another movement.
    """

    elapsed: float
    passed: float
    place: Array
    length: Array
    begins: bool = False


class Follower:
    """Sees a hand in the frame of every reach that it could be doing."""

    def __init__(self) -> None:
        self._t = math.nan
        self._moved = False

    def update(self, motion: Motion, geometry: Geometry) -> InReach | None:
        """Take the next frame; None while the hand rests or there is nothing to reach."""
        reach = motion.reach
        elapsed = reach.elapsed
        passed = elapsed if math.isnan(self._t) else min(elapsed, motion.t - self._t)
        self._t = motion.t
        begins, self._moved = not self._moved, reach.moving
        if not reach.moving or not geometry.objects:
            return None
        cylinders = geometry.cylinders()
        local, shared = np.empty((len(cylinders), len(LOCAL))), np.empty(len(SHARED))
        describe(*reach[1:], cylinders, local, shared)
        away = cylinders[:, cylinder.MIDDLE : cylinder.AXIS] - reach.start
        return InReach(
            elapsed=elapsed,
            begins=begins,
            passed=passed,
            place=local[:, [PROGRESS, DEVIATION]],
            length=np.maximum(np.linalg.norm(away, axis=1), 1e-3),
        )


def log_volume(seen: InReach) -> Array:
    """Return how much space a unit of progress and deviation is, as logarithm, shape (o,).

    A point at progress and deviation d is a circle of radius ``d L`` round the line: densities over
    them become densities in space by ``2π d L³``. Of d at least 0.01, so that it stays finite.
    """
    volume: Array = 3.0 * np.log(seen.length) + np.log(np.maximum(seen.place[:, 1], 0.01))
    return volume


class Witness:
    """Log-likelihood of each object since the onset of the movement, by id.

    Samples are counted by the time they stand for, so that a faster sensor is no better witness.
    """

    def __init__(self, step: float) -> None:
        self._step = step
        self._heard: dict[str, float] = {}
        self._elapsed = 0.0

    def hear(self, geometry: Geometry, seen: InReach, likelihood: Array) -> Array:
        """Add the log-likelihoods of a sample; return the probability of each object."""
        if seen.begins or seen.elapsed < self._elapsed:
            self._heard = {}  # another movement
        self._elapsed = seen.elapsed
        unheard = min(self._heard.values(), default=0.0)  # objects that appear on the way
        steps = seen.passed / self._step
        self._heard = {
            placed.id: self._heard.get(placed.id, unheard) + steps * float(value)
            for placed, value in zip(geometry.objects, likelihood, strict=True)
        }
        return self.shares(geometry)

    def shares(self, geometry: Geometry) -> Array:
        """Return the probability of each object by what was heard; zeros where nothing was.

        A hand that has stopped keeps what was heard of its movement until the next one.
        """
        if not self._heard:
            return np.zeros(len(geometry.objects))
        least = min(self._heard.values())
        total = np.array([self._heard.get(placed.id, least) for placed in geometry.objects])
        likely = np.exp(total - total.max(initial=-np.inf))
        share: Array = likely / likely.sum()
        return share


@cache
def library() -> dict[str, Any]:
    """Return what was learned.

    Raises
    ------
    IgripError
        If the file is not of this format.
    """
    return read_learned(LIBRARY, FORMAT)


def learned(*keys: str, shape: tuple[int, ...]) -> Array:
    """Return an array of what was learned; see :func:`igrip.learned_weights.numbers`."""
    return numbers(library(), keys, shape, LIBRARY)
