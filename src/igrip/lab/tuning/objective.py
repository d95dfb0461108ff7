"""The value of what a configuration does: right commitments, early, at 95 % right or more."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.lab.tuning.outcomes import Array, Outcomes

MIN_RIGHT = 0.95  # a commitment must be right with this probability to be worth giving
LATE_VALUE = 0.5  # of a right commitment at the end of the movement; at its onset it is 1
WRONG_COST = LATE_VALUE * MIN_RIGHT / (1.0 - MIN_RIGHT)  # 9.5: the latest breaks even at 95 %
STATED_WEIGHT = 4.0  # reaches that the stated probability counts as (docs/tuning.md)


def trial_values(outcomes: Outcomes) -> Array:
    """Return the value of each trial, shape (n,).

    ``v = q (1 - part / 2) - 9.5 (1 - q)`` for a reach with a commitment, 0 for one without;
    -9.5 for each lease in a recording without a reach.

    ``q = (n right + 4 stated) / (n + 4)`` is the probability that such a commitment is right: what
    was seen in n reaches, and the probability that the estimator stated, which counts as four more.
    Few reaches cannot show that a low threshold is safe: n without a wrong commitment are no proof
    that there will be none.
    """
    n = max(1, int(outcomes.reaches.sum()))
    known = ~np.isnan(outcomes.stated)
    pooled = (n * outcomes.right + STATED_WEIGHT * outcomes.stated) / (n + STATED_WEIGHT)
    q = np.where(known, pooled, outcomes.right)
    value = q * (1.0 - (1.0 - LATE_VALUE) * outcomes.part) - WRONG_COST * (1.0 - q)
    reach = np.where(outcomes.committed, value, 0.0)
    result: Array = np.where(outcomes.reaches, reach, -WRONG_COST * np.nan_to_num(outcomes.false))
    return result


def score(outcomes: Outcomes, folds: NDArray[np.intp]) -> float:
    """Return the mean value of trials without one fold, whichever fold that is: the lowest.

    Parameters
    ----------
    outcomes : Outcomes
        Of n trials.
    folds : (n,)
        The inner fold of each.
    """
    numbers = np.unique(folds)
    if len(numbers) < 2:
        return float(trial_values(outcomes).mean())
    return min(float(trial_values(outcomes.take(folds != k)).mean()) for k in numbers)
