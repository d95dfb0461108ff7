"""The table of trials of a dataset, ``trials.tsv``; docs/datasets.md has the format."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from igrip.errors import DatasetError
from igrip.io.cells.dialect import Dialect
from igrip.io.cells.lines import read_lines
from igrip.io.cells.values import known_text
from igrip.io.cells.values import number as number_of
from igrip.io.column_names import near_miss
from igrip.io.recordings import SOURCES


@dataclass(frozen=True)
class Trial:
    """One row of ``trials.tsv``; None: unknown.

    Attributes
    ----------
    recording : str
        Name of the recording. The table may also have its file, ``00012.jsonl``, or its path in the
        dataset, ``recordings/00012.jsonl``.
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
    header, rows = read_rows(path)
    if "recording" not in header:
        raise DatasetError(f"{path}: has no column 'recording'{near_miss('recording', header)}")
    trials = [_trial(path, number, header, cells, lenient) for number, cells in rows]
    if not trials:
        raise DatasetError(f"{path}: has no trials")
    recordings: dict[str, int] = {}
    for k, (trial, (number, _)) in enumerate(zip(trials, rows, strict=True)):
        if trial.recording in recordings:
            problem = f"{path}, line {number}: recording {trial.recording!r} is in an earlier line"
            if not lenient:
                raise DatasetError(problem)
            trials[k] = replace(trial, problem=problem)
        recordings.setdefault(trial.recording, number)
    return tuple(trials)


def read_rows(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Return the header of a table of texts, and the number and cells of each further line.

    Cells are separated by tabs, or by what the header has in their place.

    Raises
    ------
    DatasetError
        If it cannot be read; the message names what is there in its place.
    """
    if not path.is_file():
        raise DatasetError(f"{path}: is missing{_in_its_place(path)}")
    lines = read_lines(path)
    filled = [(k + 1, lines[k]) for k in range(len(lines)) if lines[k].strip()]
    if not filled:
        raise DatasetError(f"{path}: is empty")
    first = filled[0][1]
    separator = next((mark for mark in "\t;," if mark in first), "\t")
    split = Dialect(separator, ".").split
    header = [cell.strip() for cell in split(first)]
    return header, [(number, split(line)) for number, line in filled[1:]]


def _in_its_place(path: Path) -> str:
    if not path.parent.is_dir():
        return f"; there is no folder {path.parent}"
    there = sorted(other.name for other in path.parent.iterdir() if not other.name.startswith("."))
    return f"; found {', '.join(there[:8]) or 'nothing'}"


def recording_name(text: str) -> str:
    """Return the name of a recording from its name, file, or path inside the dataset."""
    name = text.strip().replace("\\", "/").removeprefix("./").removeprefix("recordings/")
    stem, dot, ending = name.rpartition(".")
    return stem if dot and stem and ending.lower() in SOURCES.names() else name


def _trial(
    path: Path, number: int, header: Sequence[str], cells: Sequence[str], lenient: bool
) -> Trial:
    if any(cell.strip() for cell in cells[len(header) :]) or len(cells) > len(header):
        raise DatasetError(f"{path}, line {number}: has more fields than the header")
    values: dict[str, Any] = {}
    extra: dict[str, str] = {}
    problem: str | None = None
    for name, cell in zip(header, cells, strict=False):
        text = known_text(cell)
        if text is None or not name:
            continue
        if name in _NUMBERS:
            # NaN is no time, as nothing else is; what is not known is empty or n/a
            value = None if text.lower() == "nan" else number_of(text, "," if "," in text else ".")
            if value is None or not math.isfinite(value):
                problem = f"{path}, line {number}, {name}: {text!r} is no time"
            else:
                values[name] = value
        elif name not in COLUMNS:
            extra[name] = text
        elif name == "recording":
            values[name] = recording_name(text)
        elif text.lower() != "nan":
            values[name] = text
    if "recording" not in values:
        raise DatasetError(f"{path}, line {number}: recording is empty")
    if values.get("onset_s", -math.inf) >= values.get("end_s", math.inf):
        problem = f"{path}, line {number}: the movement ends before it begins"
    if problem and not lenient:
        raise DatasetError(problem)
    return Trial(**values, extra=extra, problem=problem)
