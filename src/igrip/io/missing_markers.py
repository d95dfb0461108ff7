"""Numbers that stand for "not there": 0 0 0 away from the rest, −9999 and its like."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

MAX_NUMBER = 1e9  # a larger one is a place in no unit of length
MAX_STEP_RATIO = 5.0  # of a jump to 0 0 0 to the larger steps of a movement, at least


def missing_rows(positions: ArrayLike, may_rest_at_zero: bool = False) -> NDArray[np.bool_]:
    """Return which positions (n, 3) stand for "not there", in the source's own numbers.

    These are rows that are not finite; −9999 and its like (four nines or more in any component, or
    three in all); numbers over 1e9; and 0 0 0 where the positions before or after are farther away
    than any step.

    Parameters
    ----------
    positions : (n, 3)
        Before any conversion.
    may_rest_at_zero : bool
        Whether 0 0 0 throughout is a place, as of an object at the origin.
    """
    rows = np.asarray(positions, dtype=np.float64).reshape(-1, 3)
    markers = np.fromiter((_is_marker(row) for row in rows.tolist()), bool, len(rows))
    missing: NDArray[np.bool_] = np.logical_or(~np.isfinite(rows).all(axis=1), markers)
    zero = (rows == 0.0).all(axis=1) & ~missing
    real = np.flatnonzero(~missing & ~zero)
    if not len(real):
        return missing if may_rest_at_zero else missing | zero
    if zero.any():
        rows = np.where(missing[:, None], np.nan, rows)  # the square of a marker may overflow
        together = real[:-1][np.diff(real) == 1]
        steps = np.linalg.norm(rows[together + 1] - rows[together], axis=1)
        bound = MAX_STEP_RATIO * float(np.percentile(steps, 99.0)) if len(steps) else 0.0
        away = np.linalg.norm(rows, axis=1) > bound
        at = np.flatnonzero(zero)
        after = np.searchsorted(real, at)
        before, later = real[np.maximum(after - 1, 0)], real[np.minimum(after, len(real) - 1)]
        missing[at] = (away[before] & (after > 0)) | (away[later] & (after < len(real)))
    return missing


def is_missing_marker(position: Iterable[float]) -> bool:
    """Return whether numbers of one position are a marker such as −9999, unlike any place."""
    return _is_marker(list(position))


def _is_marker(row: list[float]) -> bool:
    nines = [_nines(value) for value in row]
    return max(nines, default=0) >= 4 or (min(nines, default=0) >= 3 and len(set(row)) == 1)


def _nines(value: float) -> int:
    """Return of how many nines a number consists, 0 if of anything else; of a huge one 9."""
    size = abs(value)
    if size < 999.0 or size != size:
        return 0
    if size > MAX_NUMBER:
        return 9
    digits = f"{size:.10g}".replace(".", "")
    return len(digits) if not digits.strip("9") else 0
