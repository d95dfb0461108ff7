"""Importer of files of any layout, by a map of their columns."""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping, Sequence
from pathlib import Path

from igrip.errors import DatasetError
from igrip.io.column_map import TRIALS, ColumnMap
from igrip.io.column_names import near_miss
from igrip.io.importers import ImportFiles, ReachReader, RecordedReach
from igrip.io.mapped_takes import takes_in
from igrip.io.mapped_trial import TrialReader
from igrip.io.tables import Table
from igrip.io.takes.declared import Declared
from igrip.io.takes.sections import merge_tracking_systems
from igrip.io.takes.take import Take


class ColumnMapImporter:
    """Reads reaches by a map of columns.

    Parameters
    ----------
    columns : ColumnMap
        The map.
    declared : Declared, optional
        What is declared besides, in place of what the map declares.
    """

    def __init__(self, columns: ColumnMap, declared: Declared | None = None) -> None:
        self._map = columns
        self._declared = (declared or Declared()) | columns.declared
        self.name, self.license, self.source = columns.name, columns.license, columns.source

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether the table of trials is there."""
        return self._map.trials.table in files.opened

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function per row of the table of trials, or per take without such a table.

        Raises
        ------
        DatasetError
            If a table or column is missing; the message names it.
        """
        name = self._map.trials.table
        trials = files.opened.get(name)
        if isinstance(trials, DatasetError):
            raise trials
        if trials is None and name != TRIALS:
            known = files.opened
            raise DatasetError(
                f"no table {name!r}{near_miss(name, known)}; found {', '.join(known) or 'none'}"
            )
        takes = self._takes(files)
        if not isinstance(trials, Table):
            return [
                TrialReader(self._map, self._declared, number, None, {}, takes, id)
                for number, id in enumerate(takes, 1)
            ]
        columns = {name: k for k, name in enumerate(trials.columns)}
        rows = [(line, cells) for line, cells in trials.cells(range(len(columns)))]
        readers: list[ReachReader] = []
        listed: set[str | None] = set()
        for number, (line, cells) in enumerate(rows, 2):
            row = dict(zip(columns, cells, strict=True))
            reader = TrialReader(self._map, self._declared, number, line, row, takes, None)
            readers.append(reader)
            listed.add(reader.take_name())
        return readers + [self._unlisted(trial) for trial in takes if trial not in listed]

    def _unlisted(self, trial: str) -> ReachReader:
        def read() -> RecordedReach:
            raise DatasetError(
                f"trial {trial!r} has samples, but no row in table {self._map.trials.table!r}"
            )

        return read

    def _takes(self, files: ImportFiles) -> Mapping[str, Take | DatasetError]:
        """Return the takes by their trial; an error where one cannot be read."""
        takes: dict[str, Take | DatasetError] = {}
        origin: dict[str, str] = {}
        found = False
        others: list[DatasetError] = []
        wanted = self._map.samples.table
        chosen = {
            name: source for name, source in files.opened.items()
            if name != self._map.trials.table and _matches(name, source, wanted)
        }  # fmt: skip
        for name, source in merge_tracking_systems(chosen).items():
            found = True
            try:
                if isinstance(source, DatasetError):
                    raise source
                read = takes_in(name, source, self._map, self._declared)
            except DatasetError as error:
                if not self._may_be_no_take(source):
                    raise
                others.append(error)
                continue
            for trial, take in read.items():
                if trial in takes:
                    raise DatasetError(
                        f"trial {trial!r} is in two tables, {name!r} is the second, after "
                        f"{origin[trial]!r}"
                    )
                takes[trial], origin[trial] = take, name
        if not found:
            names = [name for name in files.opened if name != self._map.trials.table]
            pattern = self._map.samples.table
            raise DatasetError(
                f"no table of samples matches {pattern!r}{near_miss(pattern.strip('*'), names)}; "
                f"found {', '.join(names) or 'none'}"
            )
        if not takes and others:
            raise others[0]
        return takes

    def _may_be_no_take(self, source: Table | Path | DatasetError) -> bool:
        """Return whether a file is looked at only since the map names no files of samples."""
        samples = self._map.samples
        named = samples.table != "*" or samples.columns is not None
        holds_bodies = isinstance(source, Table) and bool(source.layout.bodies)
        return not named and not holds_bodies


def _matches(name: str, source: Table | Path | DatasetError, pattern: str) -> bool:
    below = name.rpartition("/")[2]
    if fnmatch.fnmatchcase(name, pattern) or fnmatch.fnmatchcase(below, pattern):
        return True
    # an ending in the pattern means the name of the file
    path = source if isinstance(source, Path) else getattr(source, "path", None)
    return path is not None and fnmatch.fnmatchcase(path.name, pattern)
