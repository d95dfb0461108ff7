"""Numbers that stand for "not there": 0 0 0 in a run, −9999 and its like."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def missing_rows(positions: ArrayLike, may_rest_at_zero: bool = False) -> NDArray[np.bool_]:
    """Return which positions (n, 3) stand for "not there", in the source's own numbers.

    These are rows that are not finite; 0 0 0 for two samples or more, or away from its neighbours;
    and −9999 and its like: four nines or more in any component, or three in all.

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
    zero = (rows == 0.0).all(axis=1)
    if zero.any() and not (may_rest_at_zero and zero[~missing].all()):
        near = np.zeros(len(rows), dtype=np.bool_)
        near[1:] |= zero[:-1]
        near[:-1] |= zero[1:]
        moving = rows[~missing & ~zero]
        far = len(moving) > 0 and _is_far(rows, zero, moving)
        missing |= zero & (near | far)
    return missing


def is_missing_marker(position: Iterable[float]) -> bool:
    """Return whether numbers of one position are a marker such as −9999, unlike any place."""
    return _is_marker(list(position))


def _is_marker(row: list[float]) -> bool:
    nines = [_nines(value) for value in row]
    return max(nines, default=0) >= 4 or (min(nines, default=0) >= 3 and len(set(row)) == 1)


def _nines(value: float) -> int:
    """Return of how many nines a number consists, 0 if of anything else; more than 1e30: 9."""
    size = abs(value)
    if size < 999.0 or size != size:
        return 0
    if size > 1e30:
        return 9
    digits = f"{size:.10g}".replace(".", "")
    return len(digits) if not digits.strip("9") else 0


def _is_far(rows: Array, zero: NDArray[np.bool_], moving: Array) -> bool:
    """Return whether a lone 0 0 0 is farther from the rest than the rest spans."""
    low, high = moving.min(axis=0), moving.max(axis=0)
    outside = np.maximum(np.maximum(low, -high), 0.0)
    return bool(np.linalg.norm(outside) > np.linalg.norm(high - low))
