"""Files that hold tables: found in folders, named, and read."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable
from pathlib import Path

from igrip.errors import DatasetError, requires_extra
from igrip.io.cells.lines import Lines, read_lines
from igrip.io.layouts import find_layout, read_head
from igrip.io.layouts.vicon import SECTIONS
from igrip.io.long_tables import by_body
from igrip.io.tables import FrameTable, Table, TextTable

TABLE_ENDINGS = (".csv", ".tsv", ".txt", ".trc", ".parquet")


def read_table(path: Path) -> Table:
    """Read one table.

    Raises
    ------
    MissingExtraError
        If it is Parquet, and pandas or pyarrow are not installed.
    DatasetError
        If it cannot be read as a table.
    """
    if ending_of(path) == ".parquet":
        return by_body(_read_parquet(path))
    lines = read_lines(path)
    tables = [_text_table(path, lines, *part) for part in _parts(lines)]
    tables.sort(key=lambda table: not table.layout.bodies)  # those that hold bodies first
    table = tables[0]
    table.sections = tuple(other for other in tables[1:] if other.layout.bodies)
    if not table.columns:
        raise DatasetError(f"{path}: cannot be read as a table: it is empty")
    return table if table.sections else by_body(table)


def find_files(paths: Iterable[Path], endings: Collection[str]) -> dict[str, Path]:
    """Return the files with one of the endings, by name; a folder stands for the files in it.

    A file is named by its stem; where several share one, by its path below the folder that holds
    them, with its ending where they are in one folder.
    """
    found: list[tuple[Path, Path]] = []
    for path in paths:
        if path.is_dir():
            inside = sorted(file for file in path.rglob("*") if file.is_file())
            parts = [(file, file.relative_to(path)) for file in inside]
            found += [pair for pair in parts if not any(p.startswith(".") for p in pair[1].parts)]
        else:
            found.append((path, Path(path.name)))
    found = [(file, below) for file, below in found if ending_of(file) in endings]
    files = list({file.resolve(): file for file, _ in found}.values())
    by_stem: dict[str, list[Path]] = {}
    for file in files:
        by_stem.setdefault(stem_of(file), []).append(file)
    names: dict[Path, str] = {}
    for stem, alike in by_stem.items():
        if len(alike) == 1:
            names[alike[0]] = stem
            continue
        places = [file.resolve().parent for file in alike]
        shared = os.path.commonpath(places)
        for file, place in zip(alike, places, strict=True):
            name = file.name if places.count(place) > 1 else stem
            names[file] = (place.relative_to(shared) / name).as_posix()
    return {names[file]: file for file in files}


def read_tables(paths: Iterable[Path]) -> dict[str, Table]:
    """Read tables by name; a folder stands for the tables in it and below.

    Raises
    ------
    DatasetError
        If a file cannot be read as a table.
    """
    paths = list(paths)
    for path in paths:
        if not path.is_dir() and ending_of(path) not in TABLE_ENDINGS:
            raise DatasetError(
                f"{path}: expected a file {', '.join(TABLE_ENDINGS)} or a folder of them"
            )
    named = set(paths)
    tables = {name: read_table(file) for name, file in find_files(paths, TABLE_ENDINGS).items()}
    # a text file in a folder may be a note
    return {
        name: table for name, table in tables.items()
        if ending_of(table.path) != ".txt" or len(table.columns) > 1 or table.path in named
    }  # fmt: skip


def ending_of(path: Path) -> str:
    """Return the ending of a file in lower case, without that of its compression."""
    name = path.name.lower().removesuffix(".gz")
    return Path(name).suffix


def stem_of(path: Path) -> str:
    """Return the name of a file without its ending and that of its compression."""
    name = path.name[:-3] if path.name.lower().endswith(".gz") else path.name
    return Path(name).stem


def _parts(lines: Lines) -> list[tuple[int, int]]:
    """Return the parts of a file that are tables of their own: the sections of Vicon's."""
    starts = []
    for k in range(len(lines)):
        line = lines[k]
        if len(line) < 500 and re.split(r"[,;\t]", line.strip(), maxsplit=1)[0].lower() in SECTIONS:
            below = " ".join(lines[j] for j in range(k + 1, min(k + 6, len(lines))))
            if re.search(r"\bframe\b|\bsubject\W+context\b", below, re.IGNORECASE):
                starts.append(k)
    if not starts or any(lines[k].strip() for k in range(min(starts[0], len(lines)))):
        return [(0, len(lines))]
    return list(zip(starts, [*starts[1:], len(lines)], strict=True))


def _text_table(path: Path, lines: Lines, start: int, stop: int) -> TextTable:
    head = read_head(path, lines, start, stop)
    return TextTable(head, find_layout(head))


def _read_parquet(path: Path) -> FrameTable:
    with requires_extra("pandas", "tables", "importing Parquet tables"):
        import pandas as pd
    with requires_extra("pyarrow", "tables", "importing Parquet tables"):
        import pyarrow  # noqa: F401 - pandas needs it
    try:
        return FrameTable(path, pd.read_parquet(path))
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path}: cannot be read as a table: {error}") from error
