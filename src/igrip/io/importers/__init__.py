"""Importers of other laboratories' files, one module for each layout, found by name.

An importer returns the recorded reaches; :mod:`igrip.io.resampling` turns each into observations,
and :mod:`igrip.io.import_dataset` writes them as a dataset.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from igrip.errors import DatasetError
from igrip.io.recorded_reach import Array, MovingObject, RecordedReach
from igrip.io.table_files import TABLE_ENDINGS, ending_of, read_tables
from igrip.io.tables import Table
from igrip.io.takes.files import find_take_files, open_file
from igrip.registry import Registry

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["IMPORTERS", "Array", "ImportFiles", "Importer", "MovingObject", "ReachReader",
           "RecordedReach", "find_importer"]  # fmt: skip

ReachReader = Callable[[], RecordedReach]


class ImportFiles:
    """The files and folders that the user names; all must exist."""

    def __init__(self, paths: Iterable[Path]) -> None:
        self.paths = tuple(paths)
        for path in self.paths:
            if not path.exists():
                raise DatasetError(f"{path}: no such file or folder")

    @cached_property
    def opened(self) -> dict[str, Table | Path | DatasetError]:
        """Tables and C3D files by name, or the reason why one cannot be read."""
        opened: dict[str, Table | Path | DatasetError] = {}
        for name, path in find_take_files(self.paths).items():
            try:
                opened[name] = open_file(path)
            except DatasetError as error:
                opened[name] = error
        return opened

    @cached_property
    def tables(self) -> dict[str, pd.DataFrame]:
        """The tables among the files as data frames, by their stem."""
        tables = read_tables(p for p in self.paths if p.is_dir() or ending_of(p) in TABLE_ENDINGS)
        return {name: table.frame() for name, table in tables.items()}


class Importer(Protocol):
    """Reads files of one layout.

    Attributes
    ----------
    name, license, source : str
        For ``dataset.json``.
    """

    name: str
    license: str
    source: str

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether the files have this layout."""
        ...

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function per reach, so that a long import can show its progress.

        Raises
        ------
        DatasetError
            If a file does not have this layout; of the functions, if that reach cannot be used.
        """
        ...


IMPORTERS: Registry[Importer] = Registry("importer", "igrip.io.importers", "igrip.importers")


def find_importer(files: ImportFiles) -> Importer:
    """Return the importer that recognises the files.

    Raises
    ------
    DatasetError
        If none does, or a table cannot be read.
    """
    unreadable: DatasetError | None = None
    for name in IMPORTERS.names():
        importer = IMPORTERS.get(name)
        try:
            if importer.recognises(files):
                return importer
        except DatasetError as error:
            unreadable = error  # another importer may read it in its own way
    known = ", ".join(IMPORTERS.names())
    ways = (
        f"known are {known}; for any other table write a column map: igrip import --inspect FILE "
        "--write-map map.toml, then --columns map.toml (docs/importing.md)"
    )
    if unreadable is not None:
        raise DatasetError(f"{unreadable}. {ways}") from unreadable
    found = []
    for name, source in files.opened.items():
        if isinstance(source, DatasetError):
            raise DatasetError(f"{source}. {ways}") from source
        columns = source.columns if isinstance(source, Table) else ("C3D",)
        found.append(f"{name}: {', '.join(columns[:12])}{', …' if len(columns) > 12 else ''}")
    named = [path for path in files.paths if not path.is_dir()]
    found += [str(path) for path in named if path not in _paths(files)]
    raise DatasetError(
        f"no importer recognises these files: {ways}. Found {'; '.join(found[:20]) or 'no table'}"
    )


def _paths(files: ImportFiles) -> set[Path]:
    return set(find_take_files(files.paths).values())
