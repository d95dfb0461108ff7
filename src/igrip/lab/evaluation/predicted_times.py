"""How well the times of contact and of the end of a movement were predicted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from igrip.geometry import kernel
from igrip.geometry.frame_arrays import HandArrays, ObjectArrays
from igrip.geometry.packed_models import pack
from igrip.intention import Intention
from igrip.lab.evaluation.averages import mean, numbers
from igrip.lab.evaluation.movement import smooth_positions
from igrip.lab.evaluation.recorded_trial import SLACK, Bounds, RecordedTrial
from igrip.objects.model import ObjectModel
from igrip.targets.learned.timing import CONTACT_DISTANCE

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
PARTS = (0.40, 0.60, 0.80)
EVENTS = ("contact", "end")
AFTER_END = 0.25  # s; a contact later than this after the end is not that of the reach


def contact_time(recorded: RecordedTrial, bounds: Bounds) -> float | None:
    """Return when the hand came within 8 cm of its target's surface [s].

    The first such moment after the onset, of the raw trace after a median filter and a zero-phase
    low-pass, between two samples by a straight line. None: the hand began there, never came, or
    nothing is known of the target.
    """
    onset, end = bounds
    times, palms = smooth_positions(
        np.array(recorded.hand_times), np.array(recorded.hand_positions)
    )
    within = (times >= onset) & (times <= end + AFTER_END)
    times, palms = times[within], palms[within]
    if not recorded.target_poses or not len(times):
        return None
    placed_at = [t for t, _ in recorded.target_poses]
    newest = np.maximum(np.searchsorted(placed_at, times, side="right") - 1, 0)
    poses = [recorded.target_poses[k][1] for k in newest]
    local = np.stack(
        [(palm - pose.translation) @ pose.rotation for palm, pose in zip(palms, poses, strict=True)]
    )
    gaps = surface_distances(poses[0].model, local) - CONTACT_DISTANCE
    inside = np.flatnonzero(gaps < 0.0)
    if not len(inside) or inside[0] == 0:
        return None
    k = int(inside[0])
    return float(times[k - 1] + gaps[k - 1] / (gaps[k - 1] - gaps[k]) * (times[k] - times[k - 1]))


def surface_distances(model: ObjectModel, points: Array) -> Array:
    """Return how far points (n, 3) in the frame of a mesh are from its surface, shape (n,) [m]."""
    zero = np.zeros((1, 3))
    placed = ObjectArrays(np.zeros(1, dtype=np.int64), np.eye(3)[None], zero, zero, zero)
    still, ahead = np.zeros_like(points), points[:, None]
    hands = HandArrays(points, still, ahead, np.zeros_like(ahead))
    arrays = pack({model.name: model}).arrays
    distances: Array = kernel.surfaces(arrays, placed, hands, np.zeros(3, dtype=np.int64))[0, :, 0]
    return distances


def score_times(
    hand: str | None,
    target: str | None,
    bounds: Bounds,
    contact: float | None,
    intentions: Sequence[Intention],
    last: float,
) -> dict[str, Any]:
    """Return how the newest predictions at parts of the movement predicted contact and end.

    Of each event and part: ``asked``, whether the prediction had the right target and the event was
    still to come;
    ``error`` [s], the predicted moment less the true one, None where it was not predicted;
    ``held``, whether the interval held the true one.

    Parameters
    ----------
    hand, target : str or None
        Of the trial.
    bounds : (float, float)
        Onset and end [s].
    contact : float or None
        The true time of contact [s] (:func:`contact_time`).
    intentions : sequence of Intention
        Of every hand, in order.
    last : float
        Time of the last message [s].
    """
    onset, end = bounds
    own = [i for i in intentions if i.hand == hand]
    times = np.array([i.t for i in own])
    row: dict[str, Any] = {"contact_s": contact}
    for part in PARTS:
        at = onset + part * (end - onset)
        newest = int(np.searchsorted(times, at + 1e-9, side="right")) - 1
        answer = own[newest] if newest >= 0 and at <= last + SLACK else None
        for event, truth in zip(EVENTS, (contact, end), strict=True):
            cells: tuple[bool, float | None, bool | None] = (False, None, None)
            if answer and answer.target == target and truth is not None and at < truth:
                cells = (True, *_compare(answer, event, truth))
            keys = (f"{event}_{what}_at_{part:.0%}" for what in ("asked", "error", "held"))
            row |= zip(keys, cells, strict=True)
    return row


def _compare(answer: Intention, event: str, truth: float) -> tuple[float | None, bool | None]:
    """Return the error of a predicted moment [s], and whether its interval held the true one."""
    until: float | None = getattr(answer, f"time_to_{event}")
    interval: tuple[float, float] | None = getattr(answer, f"time_to_{event}_interval")
    left = truth - answer.t
    error = None if until is None else until - left
    return error, None if interval is None else interval[0] <= left <= interval[1]


def summarise_times(rows: pd.DataFrame | Mapping[str, Any]) -> dict[str, Any]:
    """Return, for each event and part of the movement, how well it was predicted over some trials.

    ``rows`` are columns of :func:`score_times`. ``asked`` is the number of predictions with the
    right target while the event was to come, ``given`` the share of these with a prediction,
    ``median_s`` and ``p90_s`` are of its absolute error, ``bias_s`` is the median of its signed
    error (positive: predicted too late) [s], and ``held`` is the share of intervals that held the
    true moment.
    """
    return {
        event: {
            f"{part:.0%}": summary
            for part in PARTS if (summary := _summarise(rows, event, f"{part:.0%}"))
        }
        for event in EVENTS
    }  # fmt: skip


def _summarise(rows: pd.DataFrame | Mapping[str, Any], event: str, part: str) -> dict[str, Any]:
    if f"{event}_asked_at_{part}" not in rows:
        return {}
    asked = numbers(rows[f"{event}_asked_at_{part}"]) == 1.0
    error = numbers(rows[f"{event}_error_at_{part}"])
    known = error[np.isfinite(error)]
    if not asked.any():
        return {}
    summary = {"asked": int(asked.sum()), "given": len(known) / int(asked.sum())}
    if not len(known):
        return summary
    median, ninety = np.quantile(np.abs(known), (0.5, 0.9))
    return summary | {
        "median_s": float(median), "p90_s": float(ninety), "bias_s": float(np.median(known)),
        "held": mean(rows[f"{event}_held_at_{part}"]),
    }  # fmt: skip
