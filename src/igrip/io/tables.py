"""Tables in files: text of any dialect and layout, or Parquet; columns are found by their names."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from array import array
from collections.abc import Callable, Collection, Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError, requires_extra
from igrip.io.cells.dialect import BLANKS
from igrip.io.cells.lines import Lines
from igrip.io.cells.values import clock_time, date_time, is_time, number
from igrip.io.column_names import fitting_columns, near_miss, shortened
from igrip.io.layouts import Head, Layout, read_head
from igrip.io.layouts._columns import plain_layout

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


class Table(ABC):
    """A table whose columns are read on first access.

    Attributes
    ----------
    path : Path
        The file.
    layout : Layout
        Its header.
    dialect : str
        How it is written, for the user.
    sections : sequence of Table
        Further tables with bodies in the same file.
    """

    def __init__(self, path: Path, layout: Layout, dialect: str = "") -> None:
        self.path, self.layout, self.dialect = path, layout, dialect
        self.sections: tuple[Table, ...] = ()

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns, with the rows of the header joined by ``/``."""
        return tuple("/".join(path) for path in self.layout.paths)

    @abstractmethod
    def cells(self, columns: Sequence[int]) -> Iterator[tuple[int, list[str]]]:
        """Yield the number of the line and the texts of some columns, row by row."""

    def find(self, address: str, prefer: Callable[[Sequence[str]], bool] | None = None) -> int:
        """Return the column of an address.

        Parameters
        ----------
        address : str
            The name of a column, or parts of it joined by ``/`` of which the last is the lowest
            row of the header: ``Mug/X`` is ``Mug/Position/X``.
        prefer : function, optional
            Which columns to choose if an address fits several.

        Raises
        ------
        DatasetError
            If no column fits, or several do; the message names what would.
        """
        fitting = fitting_columns(address, self.layout.paths)
        if len(fitting) > 1 and prefer is not None:
            fitting = [k for k in fitting if prefer(self.layout.paths[k])] or fitting
        if len(fitting) == 1:
            return fitting[0]
        where = f"table {self.path.name!r}"
        if fitting:
            names = ", ".join(self.columns[k] for k in fitting[:8])
            raise DatasetError(f"{where}: {address!r} fits several columns: {names}")
        raise DatasetError(
            f"{where} has no column {address!r}{near_miss(address, self.columns)}; "
            f"it has {shortened(self.columns)}"
        )

    def numbers(self, columns: Sequence[int], missing: Collection[str] = ()) -> Array:
        """Return some columns as numbers, shape (rows, columns); NaN where there is none.

        Raises
        ------
        DatasetError
            If more than half of the cells of a column are neither numbers nor missing.
        """
        values = array("d")
        wrong = [0] * len(columns)
        first: list[tuple[int, str]] = [(0, "")] * len(columns)
        decimal, missing = self._decimal, {*missing, *self.layout.missing}
        for line, cells in self.cells(columns):
            for k, cell in enumerate(cells):
                value = number(cell, decimal, missing)
                if value is None:
                    first[k] = first[k] if wrong[k] else (line, cell)
                    wrong[k] += 1
                    value = math.nan
                values.append(value)
        table = np.frombuffer(values, dtype=np.float64) if len(values) else np.zeros(0)
        table = table.reshape(-1, max(1, len(columns)))
        for k, count in enumerate(wrong):
            if count > 0.5 * len(table):
                line, cell = first[k]
                raise DatasetError(
                    f"{self.path}, line {line}, {self.columns[columns[k]]}: "
                    f"{cell!r:.60} is no number"
                )
        return table

    def times(self, column: int) -> Array:
        """Return a column of times [units of the table, s for times of day], NaN where unknown."""
        values = array("d")
        wrong, first = 0, (0, "")
        begin: datetime | None = None  # dates count from the first, so that microseconds are kept
        for line, (cell,) in self.cells([column]):
            value = number(cell, self._decimal)
            if value is None and (moment := date_time(cell)) is not None:
                begin = moment if begin is None else begin
                value = (moment - begin).total_seconds()
            value = clock_time(cell) if value is None else value
            if value is None:
                first = first if wrong else (line, cell)
                wrong += 1
                value = math.nan
            values.append(value)
        if wrong > 0.5 * len(values):
            raise DatasetError(
                f"{self.path}, line {first[0]}, {self.columns[column]}: {first[1]!r:.60} is no time"
            )
        return np.array(values, dtype=np.float64)

    def is_clock(self, column: int) -> bool:
        """Return whether a column holds times of day or dates: these are in seconds."""
        for _, (cell,) in self.cells([column]):
            if cell.strip():
                return number(cell, self._decimal) is None and is_time(cell)
        return False

    def lines(self) -> list[int]:
        """Return the number of the line of each row."""
        return [line for line, _ in self.cells([0])]

    def texts(self, column: int) -> list[str]:
        """Return a column as texts, as they stand in the file."""
        return [cells[0] for _, cells in self.cells([column])]

    def frame(self) -> pd.DataFrame:
        """Return the table as a data frame: columns of numbers as such, all others as texts."""
        with requires_extra("pandas", "tables", "tables as data frames"):
            import pandas as pd
        return pd.DataFrame({name: self._column(k) for k, name in enumerate(self.columns)})

    _decimal = "."

    def _column(self, column: int) -> NDArray[Any] | list[str]:
        texts = self.texts(column)
        values = [number(text, self._decimal) for text in texts]
        numeric = any(value is not None and value == value for value in values)
        if numeric and all(re.fullmatch(r"\s*[+-]?\d{1,18}\s*", text) for text in texts):
            return np.array([int(text) for text in texts])
        if numeric and all(value is not None for value in values):
            return np.array(values, dtype=np.float64)
        if texts and set(texts) <= {"True", "False"}:
            return np.array([text == "True" for text in texts])
        return texts


class TextTable(Table):
    """A table in a text file, or a part of one."""

    def __init__(self, head: Head, layout: Layout) -> None:
        super().__init__(head.path, layout, f"{head.lines.encoding}, {head.dialect}")
        self._lines, self._split = head.lines, head.dialect.split
        self._decimal = head.dialect.decimal
        # between blanks an empty cell leaves no trace: which cells a shorter row has is not known
        self._least = len(layout.paths) if head.dialect.separator == BLANKS else 0

    def cells(self, columns: Sequence[int]) -> Iterator[tuple[int, list[str]]]:
        """Yield the number of the line and the texts of some columns, row by row."""
        split, least = self._split, self._least
        for index, line in self._lines.between(self.layout.first, self.layout.stop):
            if line and not line.isspace():
                row = split(line)
                width = len(row) if len(row) >= least else 0
                yield index + 1, [row[k] if k < width else "" for k in columns]


class FrameTable(Table):
    """A table that is a data frame."""

    def __init__(self, path: Path, frame: pd.DataFrame) -> None:
        names = [str(name) for name in frame.columns]
        layout = plain_layout(_named(path, names))
        super().__init__(path, layout, "Parquet")
        self._frame = frame

    def cells(self, columns: Sequence[int]) -> Iterator[tuple[int, list[str]]]:
        """Yield the number of the row and the texts of some columns, row by row."""
        chosen = [self._frame.iloc[:, k].tolist() for k in columns]
        for index, row in enumerate(zip(*chosen, strict=True), start=1):
            yield index, [_text(value) for value in row]

    def numbers(self, columns: Sequence[int], missing: Collection[str] = ()) -> Array:
        """Return some columns as numbers, shape (rows, columns); NaN where there is none."""
        if missing:
            return super().numbers(columns, missing)
        try:
            return self._frame.iloc[:, list(columns)].to_numpy(dtype=np.float64)
        except (TypeError, ValueError):
            return super().numbers(columns)

    def frame(self) -> pd.DataFrame:
        """Return the data frame."""
        return self._frame


def _named(path: Path, names: Sequence[str]) -> Head:
    return read_head(path, Lines("\t".join(names) + "\n" + "\t".join("0" for _ in names)))


def _text(value: object) -> str:
    """Return a value of a data frame as text; a whole number without a decimal point."""
    if value is None or value != value:
        return ""
    return str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)
