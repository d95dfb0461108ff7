"""What a configuration makes of replayed trials, one by one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.commitment import CommitmentConfig
from igrip.lab.evaluation.commitments import Lease, MessageEvidence, iterate_leases
from igrip.lab.evaluation.recorded_trial import Bounds

Array = NDArray[np.float64]


class Replay(NamedTuple):
    """A trial replayed to what commitments are decided on.

    Attributes
    ----------
    recording, participant : str
        Which.
    hand, target : str or None
        The task; a target of None: nothing was reached for.
    bounds : (float, float) or None
        Onset and end of the movement [s]; None with no target.
    seconds : float
        Length of the recording.
    messages : tuple of MessageEvidence
        Of this hand until the end of the movement; of all hands in a recording without a reach.
    """

    recording: str
    participant: str
    hand: str | None
    target: str | None
    bounds: Bounds | None
    seconds: float
    messages: tuple[MessageEvidence, ...]


class Outcomes(NamedTuple):
    """What came of trials, as columns of shape (n,); NaN where it does not apply.

    Attributes
    ----------
    part
        Part of the movement at the first commitment, 0 before the onset; NaN without one.
    right
        Whether that was for the target, 1 or 0; NaN without one.
    stated
        The probability of its object that the estimator stated then; NaN without probabilities.
    false
        Leases that began in a recording without a reach; NaN for a reach.
    """

    part: Array
    right: Array
    stated: Array
    false: Array

    @classmethod
    def of(cls, rows: Sequence[Sequence[float]]) -> Outcomes:
        """Return rows of four numbers as columns."""
        return cls(*np.array(rows, dtype=np.float64).reshape(-1, 4).T)

    def take(self, trials: NDArray[np.intp] | NDArray[np.bool_]) -> Outcomes:
        """Return some of the trials."""
        return Outcomes(*(column[trials] for column in self))

    @property
    def reaches(self) -> NDArray[np.bool_]:
        """Which of the trials are reaches, shape (n,)."""
        return np.isnan(self.false)

    @property
    def committed(self) -> NDArray[np.bool_]:
        """Which of the trials are reaches with a commitment, shape (n,)."""
        return ~np.isnan(self.part)

    def wrong(self) -> Array:
        """Return how many commitments were wrong in each trial, shape (n,)."""
        return np.where(self.reaches, self.right == 0.0, np.nan_to_num(self.false)).astype(float)


def outcome(replay: Replay, config: CommitmentConfig) -> tuple[float, float, float, float]:
    """Return what a configuration makes of one trial: a row of :class:`Outcomes`."""
    leases = iterate_leases(replay.messages, config)
    if replay.bounds is None:
        return math.nan, math.nan, math.nan, float(len(list(leases)))
    first = next(leases, None)
    if first is None:
        return math.nan, math.nan, math.nan, math.nan
    onset, end = replay.bounds
    part = max(0.0, (first.t - onset) / (end - onset))
    return part, float(first.target == replay.target), _stated(replay, first), math.nan


def _stated(replay: Replay, lease: Lease) -> float:
    """Return the probability of a lease's target when it began; NaN where scores are none."""
    confidence = next(
        message.hands[lease.hand].confidence for message in replay.messages
        if lease.hand in message.hands and message.hands[lease.hand].t == lease.t
    )  # fmt: skip
    return confidence[lease.target] if "none" in confidence else math.nan
