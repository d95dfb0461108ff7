"""Times of a recording: equal ones merged, steps of the clock named and taken out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError

Array = NDArray[np.float64]
DAY = 86400.0  # s
MAX_STEPS_BACK = 0.01  # of the rows; with more of them, the rows are in no order
MIN_JUMP = 1.0  # s; shorter ones are gaps
JUMP_FACTOR = 20.0  # of the median interval
MIN_SPEED = 0.1  # m/s of a body that was moving when the clock jumped
MIN_ROWS = 10  # fewer show no usual step
SPAN = 6  # rows before and after over which that is measured


class RepairedTimes(NamedTuple):
    """Times that increase.

    Attributes
    ----------
    times : (m,)
        Those of the kept rows [s], 0 at the first.
    rows : (m,)
        Indices of the kept rows, in order of time.
    interval : float
        Median step [s].
    remarks : list of str
        What was repaired, with its place.
    """

    times: Array
    rows: NDArray[np.intp]
    interval: float
    remarks: list[str]


def repair_times(
    times: Array, lines: Sequence[int], positions: Sequence[Array], of_day: bool = False
) -> RepairedTimes:
    """Return times that increase, and which rows they belong to.

    A clock that steps back goes on with its usual interval. So does one that jumps ahead while a
    body moves on without a jump; else that is a gap. Equal times are merged into the first.

    Parameters
    ----------
    times : (n,)
        Times of the rows [s]; NaN where unreadable.
    lines : sequence of int
        Number of the line of each row, for the remarks.
    positions : sequence of (n, 3)
        Of the bodies [m], NaN where lost.
    of_day : bool
        Whether they begin anew at midnight.

    Raises
    ------
    DatasetError
        If fewer than two times are left.
    """
    remarks: list[str] = []
    rows = np.flatnonzero(np.isfinite(times))
    if len(rows) < len(times):
        first = lines[int(np.flatnonzero(~np.isfinite(times))[0])]
        remarks.append(
            f"{len(times) - len(rows)} rows without a time left out, first in line {first}"
        )
    kept = times[rows].astype(np.float64)
    if of_day:
        kept = kept + DAY * np.cumsum(np.diff(kept, prepend=kept[:1]) < -0.5 * DAY)
    back = np.flatnonzero(np.diff(kept) < 0)
    if len(back) > max(3.0, MAX_STEPS_BACK * len(kept)):
        remarks.append("the rows are not in order of time and were sorted")
        order = np.argsort(kept, kind="stable")
        kept, rows = kept[order], rows[order]
    odd = _odd_rows(kept)
    if odd.any():
        first = lines[rows[int(np.flatnonzero(odd)[0])]]
        remarks.append(f"{int(odd.sum())} rows with an odd time left out, first in line {first}")
        kept, rows = kept[~odd], rows[~odd]
    back = np.flatnonzero(np.diff(kept) < 0)
    steps = np.diff(kept)
    usual = steps[steps > 0]
    if not len(usual):
        raise DatasetError("its times do not increase, or are fewer than two")
    interval = float(np.median(usual))
    for k in back:
        line = lines[rows[k + 1]]
        remarks.append(
            f"the clock steps back by {-steps[k]:.4g} s in line {line}; it goes on as before"
        )
        steps[k] = interval
    for k in np.flatnonzero(steps > max(MIN_JUMP, JUMP_FACTOR * interval)):
        jump = f"by {steps[k]:.4g} s in line {lines[rows[k + 1]]}"
        if _moves_on(positions, rows, int(k), interval):
            remarks.append(f"the clock jumps {jump} while the movement goes on; taken out")
            steps[k] = interval
        else:
            remarks.append(f"nothing was recorded for {steps[k]:.4g} s before line "
                           f"{lines[rows[k + 1]]}")  # fmt: skip
    new = np.concatenate([[0.0], kept[1:] - kept[0]])
    if len(back) or not np.array_equal(steps, np.diff(kept)):
        new = np.concatenate([[0.0], np.cumsum(steps)])
    equal = np.flatnonzero(np.diff(new) == 0)
    if len(equal):
        remarks.append(
            f"{len(equal)} equal times merged, first in line {lines[rows[equal[0] + 1]]}"
        )
        keep = np.concatenate([[True], np.diff(new) > 0])
        new, rows = new[keep], rows[keep]
    return RepairedTimes(new, rows, interval, remarks)


def _odd_rows(times: Array) -> NDArray[np.bool_]:
    """Return single rows whose times are far from those of their neighbours, which agree."""
    odd = np.zeros(len(times), dtype=bool)
    steps = np.diff(times)
    if len(steps) < MIN_ROWS:
        return odd
    interval = float(np.median(np.abs(steps)))
    limit = max(MIN_JUMP, JUMP_FACTOR * interval)
    far = np.abs(steps) > limit
    across = np.abs(times[2:] - times[:-2])
    odd[1:-1] = far[:-1] & far[1:] & (across < limit)
    odd[0] = far[0] and not far[1]
    odd[-1] = far[-1] and not far[-2]
    return odd


def _moves_on(positions: Sequence[Array], rows: NDArray[np.intp], k: int, interval: float) -> bool:
    """Return whether a body that moves makes no jump where the clock does."""
    before, after = rows[max(0, k - SPAN) : k + 1], rows[k + 1 : k + 2 + SPAN]
    if len(before) < 3 or len(after) < 3:
        return False
    for track in positions:
        mean_steps = [
            float(np.linalg.norm(track[part[-1]] - track[part[0]])) / (len(part) - 1)
            for part in (before, after)
        ]
        step = float(np.linalg.norm(track[after[0]] - track[before[-1]]))
        # false where a number is missing
        if min(mean_steps) > MIN_SPEED * interval and step < 3.0 * max(mean_steps):
            return True
    return False
