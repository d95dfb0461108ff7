"""Tables in long format, with a row for each body and time, as tables with columns of each body."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.cells.values import known_text
from igrip.io.column_names import PEOPLE, TRIALS, plain
from igrip.io.layouts import BodyColumns
from igrip.io.tables import Table

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
NAMES = frozenset({
    "name", "body", "object", "obj", "id", "label", "marker", "entity", "joint", "segment", "track",
    "tracker", "rigidbody", "device", "sensor", "frameid", "childframeid", "hand",
    "side", "part", "landmark", "bodyname", "objectname", "markername", "bodyid", "objectid",
    "markerid", "trackid", "trackerid", "sensorid", "deviceid", "jointname", "bodypart",
})  # fmt: skip
"""What a column is called that names the body of a row, without blanks and underscores."""
MAX_BODIES = 64
MIN_UNIQUE = 0.9  # share of rows that are the only one of their body and time
SHARED = 1.5  # bodies per time, above which all bodies share their times


def by_body(table: Table) -> Table:
    """Return a table in long format with columns for each body; any other table as it is.

    Bodies that share their times stand side by side; where each has times of its own, all but the
    first become sections.

    Parameters
    ----------
    table : Table
        With or without a column that names the body of each row.

    Raises
    ------
    DatasetError
        If a column names bodies, but several rows hold one body at one time.
    """
    column = _names_column(table)
    if column is None:
        return table
    texts = [known_text(text) or "" for text in table.texts(column)]
    names = [name for name in dict.fromkeys(texts) if name]
    if not 2 <= len(names) <= MAX_BODIES:
        return table
    body, *_ = table.layout.bodies
    time = table.layout.time if table.layout.time is not None else table.layout.frame
    assert time is not None
    moments = table.times(time)
    kept = np.flatnonzero(np.isfinite(moments) & np.array([bool(text) for text in texts]))
    trials = _codes(table, kept)
    which = np.array([names.index(texts[row]) for row in kept.tolist()])
    keys = np.stack([trials, moments[kept]], axis=1)
    found, group = np.unique(keys, axis=0, return_inverse=True)
    rows = np.full((len(found), len(names)), -1, dtype=np.int64)
    rows[group.ravel(), which] = kept
    if (rows >= 0).sum() < MIN_UNIQUE * len(kept):
        if len(found) * len(names) < MIN_UNIQUE * len(kept):
            raise DatasetError(
                f"{table.path}: {table.columns[column]!r} names {len(names)} bodies, and several "
                "rows hold the same body at the same time; give each take its own file, or a "
                "column named trial"
            )
        return table
    labels = [f"{table.columns[column]} {name}" if name.isdecimal() else name for name in names]
    if len(kept) >= SHARED * len(found) or len(np.unique(trials)) > 1:
        return _BodyTable(table, body, column, labels, rows)
    parts = [
        _BodyTable(table, body, column, [label], rows[rows[:, k] >= 0, k : k + 1])
        for k, label in enumerate(labels)
    ]
    parts[0].sections = tuple(parts[1:])
    return parts[0]


class _BodyTable(Table):
    """The rows of a table in long format, arranged by time and body."""

    def __init__(
        self, source: Table, body: BodyColumns, column: int, names: Sequence[str], rows: Rows
    ) -> None:
        self._source, self._rows, self._decimal = source, rows, source._decimal
        own = (*body.position, *body.rotation)
        shared = [k for k in range(len(source.columns)) if k != column and k not in own]
        self._places = [(k, -1) for k in shared]
        bodies = []
        for number, name in enumerate(names):
            first = len(self._places)
            self._places += [(k, number) for k in own]
            bodies.append(replace(
                body, name=name, position=(first, first + 1, first + 2),
                rotation=tuple(range(first + 3, first + len(own))),
            ))  # fmt: skip
        layout = source.layout
        paths = [
            layout.paths[k] if number < 0 else (names[number], layout.paths[k][-1])
            for k, number in self._places
        ]
        moved = {k: place for place, k in enumerate(shared)}
        heading = source.columns[column]
        super().__init__(
            source.path,
            replace(
                layout, name=f"{layout.name} in long format", paths=tuple(paths),
                bodies=tuple(bodies), remarks=(*layout.remarks, f"bodies by the column {heading}"),
                time=None if layout.time is None else moved[layout.time],
                frame=moved.get(layout.frame) if layout.frame is not None else None,
            ),
            source.dialect,
        )  # fmt: skip

    def cells(self, columns: Sequence[int]) -> Iterator[tuple[int, list[str]]]:
        """Yield the number of the line and the texts of some columns, time by time."""
        wanted = sorted({self._places[k][0] for k in columns})
        where = {k: place for place, k in enumerate(wanted)}
        rows = list(self._source.cells(wanted))
        chosen = [self._rows_of(k).tolist() for k in columns]
        firsts = self._first().tolist()
        for number, first in enumerate(firsts):
            texts = [
                rows[row[number]][1][where[self._places[k][0]]] if row[number] >= 0 else ""
                for k, row in zip(columns, chosen, strict=True)
            ]
            yield rows[first][0], texts

    def numbers(self, columns: Sequence[int], missing: Collection[str] = ()) -> Array:
        """Return some columns as numbers, shape (times, columns); NaN where there is none."""
        wanted = sorted({self._places[k][0] for k in columns})
        values = self._source.numbers(wanted, missing)
        found = np.full((len(self._rows), len(columns)), np.nan)
        for place, k in enumerate(columns):
            rows = self._rows_of(k)
            here = rows >= 0
            found[here, place] = values[rows[here], wanted.index(self._places[k][0])]
        return found

    def times(self, column: int) -> Array:
        """Return a column of times [units of the table, s for times of day], NaN where unknown."""
        return self._source.times(self._places[column][0])[self._first()]

    def is_clock(self, column: int) -> bool:
        """Return whether a column holds times of day or dates: these are in seconds."""
        return self._source.is_clock(self._places[column][0])

    def lines(self) -> list[int]:
        """Return the number of the first line of each time."""
        lines = self._source.lines()
        return [lines[row] for row in self._first().tolist()]

    def _first(self) -> Rows:
        """Return the first row of each time, in the order of the file."""
        last = np.iinfo(np.int64).max
        first: Rows = np.where(self._rows >= 0, self._rows, last).min(axis=1)
        return first

    def _rows_of(self, column: int) -> Rows:
        number = self._places[column][1]
        return self._first() if number < 0 else self._rows[:, number]


def _names_column(table: Table) -> int | None:
    """Return the column that names the body of each row; None if the table has no such rows."""
    layout = table.layout
    timed = layout.time is not None or layout.frame is not None
    if not layout.name.startswith("table") or not timed or [b.name for b in layout.bodies] != [""]:
        return None
    used = {layout.time, layout.frame, *layout.bodies[0].position, *layout.bodies[0].rotation}
    found = [
        k for k, name in enumerate(table.columns)
        if k not in used and plain(name) in NAMES
    ]  # fmt: skip
    return found[0] if found else None


def _codes(table: Table, rows: Rows) -> Array:
    """Return a number for the trial of each row, in the order of the trials in the file."""
    columns = [k for k, name in enumerate(table.columns) if plain(name) in TRIALS | PEOPLE]
    codes: dict[tuple[str, ...], int] = {}
    texts = list(zip(*(table.texts(k) for k in columns), strict=True))
    trials = [codes.setdefault(texts[row], len(codes)) if texts else 0 for row in rows.tolist()]
    return np.array(trials, dtype=np.float64)
