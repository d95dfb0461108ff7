"""Takes of files of any kind."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from igrip.io.table_files import TABLE_ENDINGS, ending_of, find_files, read_table
from igrip.io.tables import Table
from igrip.io.takes.c3d import is_c3d, read_c3d
from igrip.io.takes.declared import Declared
from igrip.io.takes.tables import take_of
from igrip.io.takes.take import Take

TAKE_ENDINGS = (*TABLE_ENDINGS, ".c3d")


def find_take_files(paths: Iterable[Path]) -> dict[str, Path]:
    """Return the files that may hold takes, by name; a folder stands for the files in it."""
    return {
        name: path for name, path in find_files(paths, TAKE_ENDINGS).items()
        if not path.name.lower().removesuffix(".gz").endswith(("_channels.tsv", "_events.tsv"))
    }  # fmt: skip


def open_file(path: Path) -> Table | Path:
    """Return a table, or the path of a C3D file."""
    return path if ending_of(path) == ".c3d" or is_c3d(path) else read_table(path)


def read_take(name: str, source: Table | Path, declared: Declared) -> Take:
    """Return what an opened file holds.

    Raises
    ------
    DatasetError
        If it holds no take that can be read.
    """
    if isinstance(source, Path):
        return read_c3d(name, source, declared)
    return take_of(name, source, declared)
