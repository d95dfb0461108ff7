"""Takes of several tables: sections of one file, or tracking systems that recorded together."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from igrip.errors import DatasetError
from igrip.io.tables import Table
from igrip.io.takes.build import build_take
from igrip.io.takes.declared import Declared
from igrip.io.takes.take import Take, Track
from igrip.io.takes.times import raw_bodies, times_of

_SYSTEM = re.compile(r"_tracksys-[^_]+", re.IGNORECASE)
Source = TypeVar("Source")


def table_take(name: str, table: Table, declared: Declared) -> Take:
    """Return the take of one table alone.

    Raises
    ------
    DatasetError
        If it has no times; the message says what to declare.
    """
    layout = table.layout
    times, of_day = times_of(table, declared)
    frame = declared.frame(layout)
    if not of_day and _from_rate(table, declared):
        frame = (declared | Declared(time_unit="s")).frame(layout)
        times = times / frame.seconds
    remarks = list(layout.remarks)
    bodies = raw_bodies(table, layout.bodies, declared, remarks)
    return build_take(
        name, layout.name, times, table.lines(), bodies, frame, layout.zero_is_missing, of_day,
        remarks,
    )  # fmt: skip


def with_sections(take: Take, table: Table, declared: Declared) -> Take:
    """Return the take with the bodies of the further sections, each at its own rate."""
    if not table.sections:
        return take
    tracks, kinds, gaps = dict(take.tracks), dict(take.kinds), dict(take.gaps)
    remarks = list(take.remarks)
    begin = _begin(table, declared)
    for section in table.sections:
        title = section.layout.name if section.path == table.path else section.path.name
        try:
            other = table_take(take.name, section, declared)
            shift = _begin(section, declared) - begin
        except DatasetError as error:
            remarks.append(f"{title}: left out: {error}")
            continue
        if not -other.seconds < shift < take.seconds:
            remarks.append(f"{title}: its clock is another, it is taken to begin with the rest")
            shift = 0.0
        if abs(other.interval - take.interval) > 0.01 * take.interval:
            remarks.append(f"{title}: has {1.0 / other.interval:.4g} samples a second")
        remarks += [remark for remark in other.remarks if remark not in remarks]
        for key, track in other.tracks.items():
            kind = other.kinds[key]
            new = f"{key} ({kind})" if key in tracks else key
            while new in tracks:
                new += "'"
            tracks[new], kinds[new], gaps[new] = _moved(track, shift), kind, other.gaps.get(key, 0)
    return replace(take, tracks=tracks, kinds=kinds, gaps=gaps, remarks=remarks)


def merge_tracking_systems(
    sources: Mapping[str, Table | Path | Source],
) -> dict[str, Table | Path | Source]:
    """Return opened files, with those of several tracking systems of one run of Motion-BIDS as one.

    The first that holds positions gets the others as sections.
    """
    groups: dict[tuple[Path, str], list[str]] = {}
    for name, source in sources.items():
        if isinstance(source, Table) and _SYSTEM.search(source.path.name):
            key = source.path.parent, _SYSTEM.sub("", source.path.name)
            groups.setdefault(key, []).append(name)
    merged = dict(sources)
    for names in groups.values():
        moving = [name for name in names if _moves(sources[name])]
        if len(names) > 1 and moving:
            main = sources[moving[0]]
            assert isinstance(main, Table)
            others = [sources[name] for name in moving[1:]]
            main.sections = tuple(other for other in others if isinstance(other, Table))
            for name in names:
                if name != moving[0]:
                    del merged[name]
    return merged


def _moves(source: object) -> bool:
    return isinstance(source, Table) and bool(source.layout.bodies)


def _moved(track: Track, shift: float) -> Track:
    return replace(track, times=track.times + shift, lost=track.lost + shift) if shift else track


def _begin(table: Table, declared: Declared) -> float:
    """Return the time of the first row on the clock of the system [s]; frames count from 1."""
    times, of_day = times_of(table, declared)
    known = times[np.isfinite(times)]
    if not len(known):
        raise DatasetError(f"{table.path}: has no times")
    if _from_rate(table, declared):
        rate = declared.rate or table.layout.rate or 1.0
        return float(known[0]) - (1.0 / rate if table.layout.frame is not None else 0.0)
    return float(known[0] if of_day else declared.frame(table.layout).times(known[:1])[0])


def _from_rate(table: Table, declared: Declared) -> bool:
    column = table.layout.time
    return column is None or bool(declared.rate and column == table.layout.frame)
