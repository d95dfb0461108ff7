"""Folds of trials. Trials of one group are never on both sides of a split."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

OUTER, INNER = 5, 4  # folds


def folds_of(groups: Sequence[str], folds: int, seed: int) -> NDArray[np.intp]:
    """Return the fold of each trial, shape (n,).

    Groups are dealt to the folds in an order drawn by ``seed``. There are never more folds than
    groups.
    """
    names, index = np.unique(np.asarray(groups), return_inverse=True)
    count = max(1, min(folds, len(names)))
    order = np.random.default_rng(seed).permutation(len(names))
    dealt = np.empty(len(names), dtype=np.intp)
    dealt[order] = np.arange(len(names)) % count
    fold: NDArray[np.intp] = dealt[index]
    return fold
