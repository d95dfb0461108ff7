"""Where a body was lost: missing numbers, numbers that stand for one, and zeros."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.io.missing_markers import missing_rows

Array = NDArray[np.float64]
MIN_ZERO_JUMP = 10.0  # of the median step: from a zero that is no measurement to its neighbours


class Lost(NamedTuple):
    """Where a body was lost, and why.

    Attributes
    ----------
    rows : (n,)
        True where it was lost.
    sentinels, zeros : int
        How many of them hold a number such as -9999, or zeros.
    first : int
        Row of the first of these; -1 without any.
    """

    rows: NDArray[np.bool_]
    sentinels: int
    zeros: int
    first: int


def find_lost(positions: Array, zero_is_missing: bool = False) -> Lost:
    """Return in which rows a body was lost.

    Zeros are a measurement where the body comes from or goes to their neighbourhood, and stand for
    a lost body where it would have to jump there and back.

    Parameters
    ----------
    positions : (n, 3)
        In the units of the file, NaN where missing.
    zero_is_missing : bool
        Whether zeros always stand for a lost body.
    """
    missing = ~np.isfinite(positions).all(axis=1)
    zero = (positions == 0.0).all(axis=1)
    sentinel = missing_rows(positions) & ~missing & ~zero
    if zero.any() and not zero_is_missing:
        zero = _impossible_zeros(positions, zero, missing | sentinel)
    marked = np.flatnonzero(sentinel | zero)
    return Lost(
        missing | sentinel | zero, int(sentinel.sum()), int(zero.sum()),
        int(marked[0]) if len(marked) else -1,
    )  # fmt: skip


def _impossible_zeros(
    positions: Array, zero: NDArray[np.bool_], other: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return the runs of zeros that a body would have to jump to, and from."""
    seen = np.flatnonzero(~zero & ~other)
    if len(seen) < 2:
        return zero if len(seen) else np.zeros(len(zero), dtype=bool)
    next_to = np.diff(seen) == 1
    steps = np.linalg.norm(np.diff(positions[seen], axis=0), axis=1)[next_to]
    steps = steps[steps > 0]
    usual = float(np.median(steps)) if len(steps) else 0.0
    found = np.zeros(len(zero), dtype=bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], zero, [False]]).astype(int)))
    for begin, end in edges.reshape(-1, 2):
        neighbours = [positions[k] for k in (begin - 1, end) if 0 <= k < len(zero)]
        distances = [float(np.linalg.norm(p)) for p in neighbours if np.isfinite(p).all()]
        if distances and min(distances) > MIN_ZERO_JUMP * usual:
            found[begin:end] = True
    return found
