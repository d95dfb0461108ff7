"""Importers of other laboratories' files, one module for each layout, found by name.

An importer returns the recorded reaches; :mod:`igrip.io.resampling` turns each into observations,
and :mod:`igrip.io.import_dataset` writes them as a dataset.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.tables import TABLE_ENDINGS, read_tables
from igrip.registry import Registry

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RecordedReach:
    """One recorded movement of one hand towards one of several objects.

    Attributes
    ----------
    name : str
        Name of the recording.
    participant, trial, hand, target : str
        The person, the trial, the hand that moved, and the id of the object it moved to.
    times : (n,)
        Times of the samples [s], increasing; 0 at movement onset.
    positions : (n, 3)
        Positions of the hand [m].
    object_positions : mapping of str to (3,)
        Position of each object [m].
    extra : mapping of str to str
        Further columns of the table of trials.
    grip, movement : str or None
        Of the task.
    models : mapping of str to str
        Model of each object, where it is not that of the options.
    movement_only : bool
        Whether the samples hold the movement alone. If not, onset and end are left to the
        evaluation, and no rest is added before them.

    Raises
    ------
    DatasetError
        If the times do not increase, a number is not finite, or the target has no position.
    """

    name: str
    participant: str
    trial: str
    hand: str
    target: str
    times: Array
    positions: Array
    object_positions: Mapping[str, Array]
    extra: Mapping[str, str] = field(default_factory=dict)
    grip: str | None = None
    movement: str | None = None
    models: Mapping[str, str] = field(default_factory=dict)
    movement_only: bool = True

    def __post_init__(self) -> None:
        finite = len(self.times) > 1 and np.isfinite(self.times).all()
        if not finite or not (np.diff(self.times) > 0).all():
            raise DatasetError(f"{self.name}: its times do not increase, or are fewer than two")
        if not np.isfinite(self.positions).all():
            raise DatasetError(f"{self.name}: has positions that are not finite")
        if not all(np.isfinite(position).all() for position in self.object_positions.values()):
            raise DatasetError(f"{self.name}: an object's position is not finite")
        if self.target not in self.object_positions:
            raise DatasetError(f"{self.name}: its target {self.target!r} has no position")


ReachReader = Callable[[], RecordedReach]


class ImportFiles:
    """The files and folders that the user names; all must exist."""

    def __init__(self, paths: Iterable[Path]) -> None:
        self.paths = tuple(paths)
        for path in self.paths:
            if not path.exists():
                raise DatasetError(f"{path}: no such file or folder")

    @cached_property
    def tables(self) -> dict[str, pd.DataFrame]:
        """The tables among the files by their stem; see :func:`igrip.io.tables.read_tables`."""
        return read_tables(p for p in self.paths if p.is_dir() or p.suffix in TABLE_ENDINGS)


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
    if unreadable is not None:
        raise unreadable
    found = [f"{name}: {', '.join(map(str, t.columns))}" for name, t in files.tables.items()]
    found += [str(path) for path in files.paths if path.suffix not in TABLE_ENDINGS]
    known = ", ".join(IMPORTERS.names())
    raise DatasetError(
        f"no importer recognises these files (known: {known}). Found {'; '.join(found)}"
    )
