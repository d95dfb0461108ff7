"""Whether stated probabilities hold: calibration error, Brier score, and intervals of means."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import bootstrap

Array = NDArray[np.float64]
BINS = 10


class ReliabilityBins(NamedTuple):
    """Predictions by their stated probability, in bins of equal width. The bins of sets add up."""

    answers: NDArray[np.int64]  # (bins,): how many
    stated: Array  # (bins,): sums of their probabilities
    correct: Array  # (bins,): how many were correct

    @classmethod
    def of(cls, stated: Sequence[float], correct: Sequence[bool]) -> ReliabilityBins:
        """Bin predictions by their stated probability in [0, 1]."""
        p, flags = np.asarray(stated, dtype=np.float64), np.asarray(correct, dtype=np.float64)
        index = np.minimum((p * BINS).astype(int), BINS - 1)
        count: NDArray[np.int64] = np.bincount(index, minlength=BINS)
        sums = (np.bincount(index, weights=w, minlength=BINS) for w in (p, flags))
        return cls(count, *(one.astype(np.float64) for one in sums))

    def calibration_error(self) -> float:
        """Return the expected calibration error; NaN without predictions.

        The mean gap between stated probability and share of correct predictions in a bin, weighted
        by their number (Naeini et al. 2015, AAAI 29:2901-2907; Guo et al. 2017, ICML 34:1321-1330).
        """
        total = self.answers.sum()
        return float(np.abs(self.stated - self.correct).sum() / total) if total else float("nan")


def squared_error(probability: Mapping[str, float], truth: str) -> float:
    """Return the squared error of one prediction over all classes; its mean is the Brier score.

    In [0, 2] (Brier 1950, Mon. Weather Rev. 78:1-3); a true class without probability had 0.
    """
    error = sum((p - (name == truth)) ** 2 for name, p in probability.items())
    return error + (0.0 if truth in probability else 1.0)


def interval_over_groups(
    values: ArrayLike, groups: ArrayLike, draws: int = 2000, level: float = 0.95, seed: int = 0
) -> tuple[float, float]:
    """Return a bootstrap interval of a mean, over groups (participants) drawn with replacement.

    The percentile interval (Efron & Tibshirani 1993) of ``values`` (n,), where NaN does not count,
    with the group of each in ``groups`` (n,). Both ends are NaN with fewer than two groups.
    """
    column = np.asarray(values, dtype=np.float64)
    known = np.isfinite(column)
    _, index = np.unique(np.asarray(groups)[known], return_inverse=True)
    sums, counts = np.bincount(index, weights=column[known]), np.bincount(index)
    if len(counts) < 2:
        return float("nan"), float("nan")

    def mean(sums: Array, counts: Array, axis: int) -> Array:
        of_all: Array = sums.sum(axis=axis) / counts.sum(axis=axis)
        return of_all

    interval = bootstrap(
        (sums, counts), mean, paired=True, method="percentile",
        n_resamples=draws, confidence_level=level, random_state=np.random.default_rng(seed),
    ).confidence_interval  # fmt: skip
    return float(interval.low), float(interval.high)
