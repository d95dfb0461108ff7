"""The table of trials of a dataset, ``trials.tsv`` (DESIGN §4)."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from igrip.errors import DatasetError


@dataclass(frozen=True)
class Trial:
    """One row of ``trials.tsv``; None: unknown.

    Attributes
    ----------
    recording : str
        Name of the recording, without folder and ending.
    participant, trial, camera, camera_side : str or None
        The person, the trial, the camera and its side (left or right).
    hand, target, grip, movement : str or None
        The task. ``target`` is the id of an object in the recording, ``none``: no reach.
    onset_s, end_s : float or None
        Of the movement, on the recording's clock [s].
    performed, repeat_of : str or None
        Whether the task was done, and the trial that this one repeats.
    extra : mapping of str to str
        Further columns.
    problem : str or None
        The error in the row, where the table was read leniently.
    """

    recording: str
    participant: str | None = None
    trial: str | None = None
    camera: str | None = None
    camera_side: str | None = None
    hand: str | None = None
    target: str | None = None
    grip: str | None = None
    movement: str | None = None
    onset_s: float | None = None
    end_s: float | None = None
    performed: str | None = None
    repeat_of: str | None = None
    extra: Mapping[str, str] = field(default_factory=dict)
    problem: str | None = None


COLUMNS = tuple(f.name for f in fields(Trial) if f.name not in ("extra", "problem"))
_NUMBERS = ("onset_s", "end_s")


def read_trials(path: Path, lenient: bool) -> Sequence[Trial]:
    """Return the rows of the table; see :meth:`igrip.io.datasets.dataset.Dataset.open`."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file, delimiter="\t")
            if "recording" not in (reader.fieldnames or ()):
                raise DatasetError(f"{path}: has no column 'recording'")
            rows = enumerate(reader, start=2)
            trials = [_trial(path, number, row, lenient) for number, row in rows]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DatasetError(f"{path}: {error}") from error
    recordings: set[str] = set()
    for k, trial in enumerate(trials):
        if trial.recording in recordings:
            problem = f"{path}, line {k + 2}: recording {trial.recording!r} is in an earlier line"
            if not lenient:
                raise DatasetError(problem)
            trials[k] = replace(trial, problem=problem)
        recordings.add(trial.recording)
    return tuple(trials)


def _trial(path: Path, number: int, row: Mapping[str | None, Any], lenient: bool) -> Trial:
    if None in row:
        raise DatasetError(f"{path}, line {number}: has more fields than the header")
    values: dict[str, Any] = {}
    extra: dict[str, str] = {}
    problem: str | None = None
    for name, cell in row.items():
        text = (cell or "").strip()
        if name is None or not text:
            continue
        if name in _NUMBERS:
            try:
                values[name] = float(text)
            except ValueError:
                values[name] = math.nan
            if not math.isfinite(values[name]):
                problem = f"{path}, line {number}, {name}: {text!r} is no time"
                del values[name]
        elif name not in COLUMNS:
            extra[name] = text
        elif name == "recording" or text.lower() != "nan":
            values[name] = text
    if "recording" not in values:
        raise DatasetError(f"{path}, line {number}: recording is empty")
    if values.get("onset_s", -math.inf) >= values.get("end_s", math.inf):
        problem = f"{path}, line {number}: the movement ends before it begins"
    if problem and not lenient:
        raise DatasetError(problem)
    return Trial(**values, extra=extra, problem=problem)
