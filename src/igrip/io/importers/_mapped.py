"""Tables of any layout, with a map that says which column is what (a TOML file)."""

from __future__ import annotations

import fnmatch
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from igrip.errors import DatasetError
from igrip.io.importers import RecordedReach

if TYPE_CHECKING:
    import pandas as pd

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
SECONDS = {"s": 1.0, "ms": 0.001}


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Samples(_Part):
    """Which columns of which tables hold the positions of the hand, a row a sample."""

    table: str = "*"
    trial: str | None = None  # without it each table is one trial, named as its file
    t: str = "t"
    x: str = "x"
    y: str = "y"
    z: str = "z"


class Trials(_Part):
    """Which columns of which table describe the trials; ``=text`` stands for a text itself."""

    table: str = "trials"
    trial: str = "trial"
    participant: str = "participant"
    hand: str = "hand"
    target: str = "target"
    grip: str | None = None
    movement: str | None = None


class Place(_Part):
    """Where an object is: columns of the table of trials, or numbers; and its model."""

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
    samples: Samples = Samples()
    trials: Trials = Trials()
    objects: Mapping[str, Place]


def read_map(path: Path) -> ColumnMap:
    """Read a map of columns.

    Raises
    ------
    DatasetError
        If it cannot be read, or says something unknown; the message names it.
    """
    try:
        return ColumnMap.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise DatasetError(f"{path}: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise DatasetError(f"{path}: {where}: {first['msg']}") from None


class Mapped:
    """Reads reaches from tables by a map; an :class:`igrip.io.importers.Importer`."""

    def __init__(self, columns: ColumnMap) -> None:
        self._map = columns
        self.name, self.license, self.source = columns.name, columns.license, columns.source

    def recognises(self, tables: Mapping[str, pd.DataFrame]) -> bool:
        """Whether the table of trials is there; its columns are asked for when they are read."""
        return self._map.trials.table in tables

    def reaches(self, tables: Mapping[str, pd.DataFrame]) -> Sequence[Callable[[], RecordedReach]]:
        """Return one function per row of the table of trials.

        Raises
        ------
        DatasetError
            If a table or column is missing; the message names it.
        """
        named = self._map.trials.table
        if named not in tables:
            raise DatasetError(f"no table {named!r}; found {', '.join(tables) or 'none'}")
        rows = tables[named].to_dict("records")
        samples = self._samples(tables)
        readers = [self._reader(number, row, samples) for number, row in enumerate(rows, start=2)]
        listed = {_text(row.get(self._map.trials.trial)) for row in rows}
        return readers + [self._orphan(name) for name in samples if name not in listed]

    def _orphan(self, name: str) -> Callable[[], RecordedReach]:
        def read() -> RecordedReach:
            raise DatasetError(
                f"trial {name!r} has samples, but no row in table {self._map.trials.table!r}"
            )

        return read

    def _samples(self, tables: Mapping[str, pd.DataFrame]) -> Mapping[str, Any]:
        """Return times and positions of each trial, shape (n, 4), in the tables' own units."""
        want = self._map.samples
        columns = [want.t, want.x, want.y, want.z]
        found: dict[str, Any] = {}
        for stem, table in tables.items():
            if stem == self._map.trials.table or not fnmatch.fnmatch(stem, want.table):
                continue
            missing = [
                c for c in [*columns, want.trial] if c is not None and c not in table.columns
            ]
            if missing:
                raise DatasetError(
                    f"table {stem!r} has no column {missing[0]!r}; "
                    f"it has {', '.join(map(str, table.columns))}"
                )
            parts = [(stem, table)] if want.trial is None else table.groupby(want.trial, sort=False)
            for name, part in parts:
                try:
                    values = part[columns].to_numpy(dtype=np.float64)
                except (TypeError, ValueError) as error:
                    raise DatasetError(f"table {stem!r}: {error}") from None
                key = _text(name) or ""
                if key in found:
                    raise DatasetError(f"trial {key!r} is in two tables, {stem!r} is the second")
                found[key] = values
        return found

    def _reader(
        self, number: int, row: Mapping[Any, Any], samples: Mapping[str, Any]
    ) -> Callable[[], RecordedReach]:
        want = self._map.trials
        where = f"table {want.table!r}, line {number}"

        def cell(column: str | None) -> str | None:
            if column is None:
                return None
            if column.startswith("="):
                return column[1:]
            if column not in row:
                raise DatasetError(f"{where}: no column {column!r}")
            return _text(row[column])

        def needed(column: str) -> str:
            text = cell(column)
            if text is None:
                raise DatasetError(f"{where}: {column!r} is empty")
            return text

        def read() -> RecordedReach:
            trial = needed(want.trial)
            if trial not in samples:
                raise DatasetError(f"{where}: trial {trial!r} has no samples")
            values = samples[trial]
            seen = values[np.isfinite(values).all(axis=1)]  # where the marker was lost: a gap
            order = np.argsort(seen[:, 0], kind="stable")
            times = seen[order, 0] * SECONDS[self._map.time_unit]
            return RecordedReach(
                name="".join(c if c.isalnum() or c in "-_" else "_" for c in f"{number}_{trial}"),
                participant=cell(want.participant) or "unknown", trial=trial,
                hand=needed(want.hand),
                target=needed(want.target), times=times - (times[0] if len(times) else 0.0),
                positions=seen[order, 1:] * METRES[self._map.unit],
                places={id: self._place(place, needed, where) for id, place in
                        self._map.objects.items()},
                models={id: p.model for id, p in self._map.objects.items() if p.model},
                grip=_grip(cell(want.grip), where),
                movement=cell(want.movement), whole=False,
            )  # fmt: skip

        return read

    def _place(self, place: Place, cell: Callable[[str], str], where: str) -> Any:
        numbers = []
        for axis in (place.x, place.y, place.z):
            try:
                numbers.append(axis if isinstance(axis, float) else float(cell(axis)))
            except ValueError:
                raise DatasetError(f"{where}, column {axis!r}: is no number") from None
        return np.array(numbers) * METRES[self._map.unit]


def _text(value: object) -> str | None:
    """Return a cell as text, None for an empty one; whole numbers as people write them."""
    if value is None or value != value:  # NaN stands for an empty cell
        return None
    text = str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)
    text = text.strip()
    return (str(int(text)) if text.isdecimal() else text) or None  # a file 01 is trial 1


def _grip(text: str | None, where: str) -> str | None:
    if text is not None and text.lower() not in ("palmar", "pinch"):
        raise DatasetError(f"{where}: grip {text!r} is neither palmar nor pinch")
    return None if text is None else text.lower()
