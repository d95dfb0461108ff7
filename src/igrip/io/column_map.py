"""Importer of tables of any layout, by a map of their columns (a TOML file)."""

from __future__ import annotations

import fnmatch
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from igrip.errors import DatasetError
from igrip.io.importers import Array, ImportFiles, ReachReader, RecordedReach

if TYPE_CHECKING:
    import pandas as pd

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
SECONDS = {"s": 1.0, "ms": 0.001}


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class SampleColumns(_Part):
    """The tables and columns of the hand's positions, one row per sample."""

    table: str = "*"
    trial: str | None = None  # without it each table is one trial, named as its file
    t: str = "t"
    x: str = "x"
    y: str = "y"
    z: str = "z"


class TrialColumns(_Part):
    """The table and columns of the trials, one row per trial; ``=text`` is the text itself."""

    table: str = "trials"
    trial: str = "trial"
    participant: str = "participant"
    hand: str = "hand"
    target: str = "target"
    grip: str | None = None
    movement: str | None = None


class ObjectColumns(_Part):
    """The position of an object: columns of the table of trials, or numbers; and its model."""

    x: str | float
    y: str | float
    z: str | float
    model: str | None = None


class ColumnMap(_Part):
    """The whole map."""

    name: str = "imported tables"
    license: str = "unknown"
    source: str = "unknown"
    unit: Literal["m", "cm", "mm"] = "m"
    time_unit: Literal["s", "ms"] = "s"
    samples: SampleColumns = SampleColumns()
    trials: TrialColumns = TrialColumns()
    objects: Mapping[str, ObjectColumns]


def read_column_map(path: Path) -> ColumnMap:
    """Read a map of columns.

    Raises
    ------
    DatasetError
        If it cannot be read, or an entry is unknown or wrong; the message names it.
    """
    try:
        return ColumnMap.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise DatasetError(f"{path}: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise DatasetError(f"{path}: {where}: {first['msg']}") from None


class ColumnMapImporter:
    """Reads reaches from tables by a map of their columns."""

    def __init__(self, columns: ColumnMap) -> None:
        self._map = columns
        self.name, self.license, self.source = columns.name, columns.license, columns.source

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether the table of trials is there."""
        return self._map.trials.table in files.tables

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function per row of the table of trials.

        Raises
        ------
        DatasetError
            If a table or column is missing; the message names it.
        """
        name = self._map.trials.table
        if name not in files.tables:
            raise DatasetError(f"no table {name!r}; found {', '.join(files.tables) or 'none'}")
        rows = files.tables[name].to_dict("records")
        samples = self._samples(files.tables)
        readers: list[ReachReader] = [
            _TrialReader(self._map, number, row, samples) for number, row in enumerate(rows, 2)
        ]
        listed = {_text(row.get(self._map.trials.trial)) for row in rows}
        return readers + [self._unlisted(trial) for trial in samples if trial not in listed]

    def _unlisted(self, trial: str) -> ReachReader:
        def read() -> RecordedReach:
            raise DatasetError(
                f"trial {trial!r} has samples, but no row in table {self._map.trials.table!r}"
            )

        return read

    def _samples(self, tables: Mapping[str, pd.DataFrame]) -> Mapping[str, Array]:
        """Return times and positions of each trial, shape (n, 4), in the tables' own units."""
        want = self._map.samples
        columns = [want.t, want.x, want.y, want.z]
        samples: dict[str, Array] = {}
        for stem, table in tables.items():
            if stem == self._map.trials.table or not fnmatch.fnmatch(stem, want.table):
                continue
            for column in [*columns, want.trial]:
                if column is not None and column not in table.columns:
                    raise DatasetError(
                        f"table {stem!r} has no column {column!r}; "
                        f"it has {', '.join(map(str, table.columns))}"
                    )
            parts = [(stem, table)] if want.trial is None else table.groupby(want.trial, sort=False)
            for name, part in parts:
                try:
                    values = part[columns].to_numpy(dtype=np.float64)
                except (TypeError, ValueError) as error:
                    raise DatasetError(f"table {stem!r}: {error}") from None
                trial = _text(name) or ""
                if trial in samples:
                    raise DatasetError(f"trial {trial!r} is in two tables, {stem!r} is the second")
                samples[trial] = values
        return samples


class _TrialReader:
    """Reads the reach of one row of the table of trials."""

    def __init__(
        self, columns: ColumnMap, number: int, row: Mapping[Any, Any], samples: Mapping[str, Array]
    ) -> None:
        self._map, self._number, self._row, self._samples = columns, number, row, samples
        self._where = f"table {columns.trials.table!r}, line {number}"

    def __call__(self) -> RecordedReach:
        want, metres = self._map.trials, METRES[self._map.unit]
        trial = self._required(want.trial)
        if trial not in self._samples:
            raise DatasetError(f"{self._where}: trial {trial!r} has no samples")
        values = self._samples[trial]
        values = values[np.isfinite(values).all(axis=1)]  # a lost marker leaves a gap
        values = values[np.argsort(values[:, 0], kind="stable")]
        times = values[:, 0] * SECONDS[self._map.time_unit]
        objects = self._map.objects
        return RecordedReach(
            name=re.sub(r"[^\w-]", "_", f"{self._number}_{trial}"),
            participant=self._cell(want.participant) or "unknown",
            trial=trial,
            hand=self._required(want.hand),
            target=self._required(want.target),
            times=times - times[:1],
            positions=values[:, 1:] * metres,
            object_positions={id: self._position(o) * metres for id, o in objects.items()},
            models={id: object.model for id, object in objects.items() if object.model},
            grip=self._grip(),
            movement=self._cell(want.movement),
            movement_only=False,
        )

    def _cell(self, column: str | None) -> str | None:
        if column is None:
            return None
        if column.startswith("="):
            return column[1:]
        if column not in self._row:
            raise DatasetError(f"{self._where}: no column {column!r}")
        return _text(self._row[column])

    def _required(self, column: str) -> str:
        text = self._cell(column)
        if text is None:
            raise DatasetError(f"{self._where}: {column!r} is empty")
        return text

    def _position(self, columns: ObjectColumns) -> Array:
        numbers = []
        for axis in (columns.x, columns.y, columns.z):
            try:
                numbers.append(axis if isinstance(axis, float) else float(self._required(axis)))
            except ValueError:
                raise DatasetError(f"{self._where}, column {axis!r}: is no number") from None
        return np.array(numbers)

    def _grip(self) -> str | None:
        text = self._cell(self._map.trials.grip)
        if text is not None and text.lower() not in ("palmar", "pinch"):
            raise DatasetError(f"{self._where}: grip {text!r} is neither palmar nor pinch")
        return None if text is None else text.lower()


def _text(value: object) -> str | None:
    """Return a cell as text, None for an empty one; whole numbers without a decimal point."""
    if value is None or value != value:  # NaN stands for an empty cell
        return None
    text = str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)
    text = text.strip()
    return (str(int(text)) if text.isdecimal() else text) or None  # a file 01 is trial 1
