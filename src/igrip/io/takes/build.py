"""A take from the numbers of a file: its clock repaired, its gaps found, in igrip's frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.frames import DeclaredFrame
from igrip.io.takes.clock import repair_times
from igrip.io.takes.gaps import find_lost
from igrip.io.takes.rotations import quaternions
from igrip.io.takes.take import Take, Track

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RawBody:
    """Numbers of one body as a file holds them.

    Attributes
    ----------
    kind : str
        ``marker``, ``rigid body``, …
    positions : (n, 3)
        In the file's unit and axes, NaN where missing.
    rotations : (n, k) or None
        See :func:`igrip.io.takes.rotations.quaternions`.
    rotation_kind, degrees : str, bool
        What these numbers are.
    """

    kind: str
    positions: Array
    rotations: Array | None = None
    rotation_kind: str = "xyzw"
    degrees: bool = True


def build_take(
    name: str,
    layout: str,
    times: Array,
    lines: Sequence[int],
    bodies: Mapping[str, RawBody],
    frame: DeclaredFrame,
    zero_is_missing: bool = False,
    of_day: bool = False,
    remarks: Sequence[str] = (),
) -> Take:
    """Return a take.

    Parameters
    ----------
    name, layout : str
        Of the take, and of the file.
    times : (n,)
        Of the rows, in the unit of the frame; in seconds if ``of_day``.
    lines : sequence of int
        Number of the line of each row.
    bodies : mapping of str to RawBody
        What moves.
    frame : DeclaredFrame
        What the numbers mean.
    zero_is_missing, of_day : bool
        Whether zeros stand for a lost body; whether times are times of day.
    remarks : sequence of str
        Of the file.

    Raises
    ------
    DatasetError
        If fewer than two rows have a time.
    """
    notes = list(remarks)
    seconds = times if of_day else frame.times(times)
    lost = {key: find_lost(body.positions, zero_is_missing) for key, body in bodies.items()}
    placed = {
        key: frame.positions(np.where(lost[key].rows[:, None], np.nan, body.positions))
        for key, body in bodies.items()
    }
    try:
        clock = repair_times(seconds, lines, list(placed.values()), of_day)
    except DatasetError as error:
        raise DatasetError(f"{name}: {error}") from None
    notes += clock.remarks
    tracks: dict[str, Track] = {}
    gaps: dict[str, int] = {}
    for key, body in bodies.items():
        notes += _lost_remarks(key, lost[key].sentinels, lost[key].zeros, lost[key].first, lines)
        positions = placed[key][clock.rows]
        good = np.isfinite(positions).all(axis=1)
        turns = None
        if body.rotations is not None:
            found = quaternions(body.rotations[clock.rows], body.rotation_kind, body.degrees)
            turned = np.isfinite(found.values).all(axis=1)
            if found.rounded:
                notes.append(f"{key}: {found.rounded} quaternions were rounded and normalised")
            if turned.any():
                if (good & ~turned).any():
                    notes.append(
                        f"{key}: {int((good & ~turned).sum())} rows without a rotation left out"
                    )
                good &= turned
                turns = frame.orientations(_as_ordered(found.values, frame))[good]
            else:
                notes.append(f"{key}: has no rotation that can be used")
        tracks[key] = Track(clock.times[good], positions[good], turns, clock.times[~good])
        gaps[key] = int((~good).sum())
    return Take(
        name, layout, tracks, {key: body.kind for key, body in bodies.items()}, clock.times,
        clock.interval, frame, gaps, notes,
    )  # fmt: skip


def _as_ordered(values: Array, frame: DeclaredFrame) -> Array:
    """Return quaternions x, y, z, w in the order that the frame expects."""
    return np.roll(values, 1, axis=1) if frame.quaternions == "wxyz" else values


def _lost_remarks(
    key: str, sentinels: int, zeros: int, first: int, lines: Sequence[int]
) -> list[str]:
    where = f"first in line {lines[first]}" if first >= 0 else ""
    name = "the hand" if not key or key.startswith("\0") else key
    notes: list[str] = []
    if sentinels:
        notes.append(f"{name}: {sentinels} samples hold a number for 'not there', {where}: gaps")
    if zeros:
        notes.append(f"{name}: {zeros} samples are 0, 0, 0, {where}: gaps")
    return notes
