"""Do stated probabilities hold? Expected calibration error and Brier score."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BINS = 10


def expected_calibration_error(
    confidence: Array, correct: NDArray[np.bool_], bins: int = BINS
) -> float:
    """Return the mean gap between stated confidence and share of right answers.

    Confidences are put into bins of equal width, and the gaps of the bins weighted by what is in
    them (Naeini et al. 2015, AAAI 29:2901-2907; Guo et al. 2017, ICML 34:1321-1330).

    Parameters
    ----------
    confidence : (n,)
        Stated probability of the answer that was given, in [0, 1].
    correct : (n,)
        Whether it was right.
    bins : int
        Number of bins.

    Returns
    -------
    float
        NaN without answers.
    """
    if not len(confidence):
        return float("nan")
    index = np.minimum((confidence * bins).astype(int), bins - 1)
    count = np.bincount(index, minlength=bins)
    gap = np.abs(
        np.bincount(index, weights=confidence, minlength=bins)
        - np.bincount(index, weights=correct.astype(float), minlength=bins)
    )
    return float(gap.sum() / count.sum())


def brier_score(probability: Array, truth: NDArray[np.int64]) -> float:
    """Return the mean squared error of probabilities over all classes (Brier 1950).

    Parameters
    ----------
    probability : (n, c)
        Rows that sum to 1.
    truth : (n,)
        Index of the class that was true.

    Returns
    -------
    float
        In [0, 2]; NaN without rows.
    """
    if not len(probability):
        return float("nan")
    target = np.eye(probability.shape[1])[truth]
    return float(((probability - target) ** 2).sum(axis=1).mean())


def interval_over_groups(
    values: Array, groups: NDArray[np.int64], draws: int = 2000, level: float = 0.95, seed: int = 0
) -> tuple[float, float]:
    """Return a bootstrap interval of a mean, over groups (participants) drawn with replacement.

    Parameters
    ----------
    values : (n,)
        One per trial; NaN does not count.
    groups : (n,)
        Number of the group of each, 0, 1, ….
    draws, level, seed
        Of the bootstrap (Efron & Tibshirani 1993; percentile interval).

    Returns
    -------
    low, high : float
        NaN with fewer than two groups.
    """
    known = np.isfinite(values)
    values, groups = values[known], groups[known]
    names, groups = np.unique(groups, return_inverse=True)
    if len(names) < 2:
        return float("nan"), float("nan")
    sums, counts = np.bincount(groups, weights=values), np.bincount(groups)
    drawn = np.random.default_rng(seed).integers(0, len(names), (draws, len(names)))
    means = sums[drawn].sum(axis=1) / counts[drawn].sum(axis=1)
    low, high = np.quantile(means, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)
