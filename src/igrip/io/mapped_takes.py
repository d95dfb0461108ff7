"""Takes of a file by a map of columns: the hand of the trial, further hands, and objects."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from igrip.errors import DatasetError
from igrip.io.cells.values import known_text
from igrip.io.column_map import BodyColumns, ColumnMap
from igrip.io.column_names import near_miss
from igrip.io.hand_ids import is_hand
from igrip.io.table_files import ending_of, stem_of
from igrip.io.tables import Table
from igrip.io.takes.build import RawBody, build_take
from igrip.io.takes.declared import Declared
from igrip.io.takes.files import TAKE_ENDINGS, read_take
from igrip.io.takes.sections import with_sections
from igrip.io.takes.take import Take
from igrip.io.takes.times import raw_bodies, times_of

TRIAL_HAND = "\0hand"
"""Name of the track of the hand that the table of trials names."""


def takes_in(
    name: str, source: Table | Path, columns: ColumnMap, declared: Declared
) -> dict[str, Take | DatasetError]:
    """Return the takes of one file by the ids of their trials.

    Raises
    ------
    DatasetError
        If a column or body is missing; the message names it.
    """
    if isinstance(source, Path):
        return {trial_id(name): _with_hand(read_take(name, source, declared), columns)}
    samples = columns.samples
    time = _time_column(source, columns, declared)
    times, of_day = times_of(source, declared, time)
    remarks = list(source.layout.remarks)
    bodies = raw_bodies(source, source.layout.bodies, declared, remarks)
    lines = source.lines()
    hand = _hand_columns(source, columns)
    if hand is not None:
        bodies.pop("", None)  # the same columns without a name
        bodies[TRIAL_HAND] = _raw(source, hand, declared, remarks)
    for id, part in columns.hands.items():
        if part.columns is not None:
            bodies[f"{TRIAL_HAND}:{id}"] = _raw(source, part.columns, declared, remarks)
    unit = source.layout.length_unit
    if columns.unit and unit and columns.unit != unit:
        remarks.append(f"the file states {unit}, the map {columns.unit}: the map is used")
    from_rate = time is None and source.layout.time is None
    declared = Declared(time_unit="s") | declared if from_rate else declared
    frame = declared.frame(source.layout)

    def built(trial: str, rows: Sequence[int] | None) -> Take | DatasetError:
        chosen = slice(None) if rows is None else np.array(rows)
        parts = {
            key: RawBody(
                body.kind, body.positions[chosen],
                None if body.rotations is None else body.rotations[chosen],
                body.rotation_kind, body.degrees,
            )
            for key, body in bodies.items()
        }  # fmt: skip
        numbers = lines if rows is None else [lines[k] for k in rows]
        try:
            return build_take(
                trial, source.layout.name, times[chosen], numbers, parts, frame,
                source.layout.zero_is_missing, of_day, remarks,
            )  # fmt: skip
        except DatasetError as error:
            return error

    if samples.trial is None:
        take = built(trial_id(name), None)
        if not isinstance(take, DatasetError):
            take = _with_hand(with_sections(take, source, declared), columns)
        return {trial_id(name): take}
    groups: dict[str, list[int]] = {}
    for k, text in enumerate(source.texts(source.find(samples.trial))):
        groups.setdefault(trial_id(text), []).append(k)
    takes: dict[str, Take | DatasetError] = {}
    for trial, rows in groups.items():
        take = built(trial, rows)
        takes[trial] = take if isinstance(take, DatasetError) else _with_hand(take, columns)
    return takes


def trial_id(text: str) -> str:
    """Return the id of a trial: a file 01 is trial 1."""
    text = known_text(text) or ""
    return str(int(text)) if text.isdecimal() else text


def find_take(trial: str, participant: str | None, takes: Collection[str]) -> str | None:
    """Return the take that a row means: by its name, file or path, or by person and name.

    Parameters
    ----------
    trial, participant : str, str or None
        What the row states.
    takes : collection of str
        Names of the takes; a name with folders where several share the rest.
    """
    wanted = trial.replace("\\", "/").removeprefix("./")
    if ending_of(Path(wanted)) in TAKE_ENDINGS and wanted not in takes:
        wanted = (Path(wanted).parent / stem_of(Path(wanted))).as_posix()
    wanted = trial_id(wanted)
    if wanted in takes:
        return wanted
    depth = wanted.count("/") + 1
    found = [take for take in takes if _last_parts(take, depth) == wanted]
    if len(found) > 1 and participant:
        person = participant.casefold()
        found = [
            take for take in found
            if {person, f"sub-{person}"} & {part.casefold() for part in take.split("/")[:-1]}
        ]  # fmt: skip
    return found[0] if len(found) == 1 else None


def _last_parts(take: str, depth: int) -> str:
    *folders, name = take.split("/")[-depth:]
    return "/".join([*folders, trial_id(name)])


def find_body(name: str, take: Take) -> str:
    """Return the track of a body.

    Raises
    ------
    DatasetError
        If there is none of this name; the message names those there are.
    """
    if name in take.tracks:
        return name
    known = [key for key in take.tracks if not key.startswith(TRIAL_HAND)]
    raise DatasetError(
        f"{take.name}: no body {name!r}{near_miss(name, known)}; "
        f"there are {', '.join(known) or 'none'}"
    )


def _with_hand(take: Take, columns: ColumnMap) -> Take:
    """Return the take with the track of the trial's hand, where the map names its body."""
    body = columns.samples.body
    if body is None or TRIAL_HAND in take.tracks:
        return take
    key = find_body(body, take)
    return replace(take, tracks={**take.tracks, TRIAL_HAND: take.tracks[key]})


def _time_column(table: Table, columns: ColumnMap, declared: Declared) -> int | None:
    """Return the column of times; None: frame numbers and the rate."""
    samples = columns.samples
    if samples.t is not None:
        return table.find(samples.t)
    if samples.frame is not None:
        if not (declared.rate or table.layout.rate):
            raise DatasetError(f"{table.path}: samples.frame needs rate = … (frames per second)")
        # the frames stand in for times: times_of divides them by the rate
        return None
    return table.layout.time


def _hand_columns(table: Table, columns: ColumnMap) -> tuple[str, str, str] | None:
    samples = columns.samples
    if samples.columns is not None:
        return samples.columns
    if samples.body is not None or columns.hands:
        return None
    if {"x", "y", "z"} <= set(table.columns):
        return "x", "y", "z"
    hands = [body for body in table.layout.bodies if is_hand(body.name)]
    if hands:
        return None  # found by their names
    for axis in "xyz":
        table.find(axis)  # names what is missing
    return None


def _raw(
    table: Table, names: tuple[str, str, str], declared: Declared, remarks: list[str]
) -> RawBody:
    """Return the numbers of a body by the names of its columns."""
    found = [table.find(name, prefer=_of_a_hand) for name in names]
    for name, k in zip(names, found, strict=True):
        if sum(path[-1] == name for path in table.layout.paths if path) > 1:
            remarks.append(f"several columns are named {name}; taken {table.columns[k]}")
    return RawBody("marker", table.numbers(found, declared.missing))


def _of_a_hand(path: Sequence[str]) -> bool:
    """Return whether a column is the position of a hand, by its names."""
    return any(is_hand(part) for part in path[:-1]) and not any(
        "rot" in part.lower() for part in path
    )


def hand_tracks(take: Take, hands: dict[str, BodyColumns]) -> dict[str, str]:
    """Return the tracks of the hands that a map names, by their ids."""
    return {
        id: f"{TRIAL_HAND}:{id}" if part.columns is not None else find_body(part.body or id, take)
        for id, part in hands.items()
    }
