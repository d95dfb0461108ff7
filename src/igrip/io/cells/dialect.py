"""The separator and the decimal mark of a text table."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from igrip.io.cells.values import is_time, number

BLANKS = " "  # any number of blanks between cells
_SEPARATORS = ("\t", ";", ",", "|", BLANKS)
_NAMES = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar", BLANKS: "blanks"}


class Dialect(NamedTuple):
    """How the lines of a table are written.

    Attributes
    ----------
    separator : str
        Between cells; a blank stands for any number of blanks.
    decimal : str
        Decimal mark, ``.`` or ``,``.
    """

    separator: str
    decimal: str

    def split(self, line: str) -> list[str]:
        """Return the cells of a line."""
        if self.separator == BLANKS:
            return line.split()
        if '"' not in line:
            return line.split(self.separator)
        try:
            return next(csv.reader([line], delimiter=self.separator), [])
        except csv.Error:  # a cell without an end
            return line.split(self.separator)

    def __str__(self) -> str:
        mark = "point" if self.decimal == "." else "comma"
        return f"{_NAMES[self.separator]} between cells, decimal {mark}"


def find_dialect(lines: Sequence[str]) -> Dialect:
    """Return the dialect of a table from some of its lines.

    The best reads the most cells as numbers. Where none reads a number (a table of texts), it is
    the one by which the most lines have the same number of cells as the first line.
    """
    lines = [line for line in lines if line.strip()]
    if lines and (declared := lines[0].strip().lower()).startswith("sep=") and len(declared) == 5:
        lines = lines[1:]  # a line for spreadsheets
    best, best_score = Dialect(",", "."), (0.0, 0.0, 0.0)
    for separator in _SEPARATORS:
        for decimal in ".,":
            dialect = Dialect(separator, decimal)
            if separator == decimal and not any('"' in line for line in lines):
                continue
            score = _score(dialect, lines)
            if score > best_score:
                best, best_score = dialect, score
    return best


def is_value(text: str, decimal: str) -> bool:
    """Return whether a cell is a number or a time, and not empty."""
    value = number(text, decimal)
    return bool(text.strip()) and (value is not None or is_time(text))


def _score(dialect: Dialect, lines: Sequence[str]) -> tuple[float, float, float]:
    """Return the share of lines of numbers, their agreement in width, and the width."""
    of_numbers, widths = 0, Counter[int]()
    for line in lines:
        cells = dialect.split(line)
        full = [cell for cell in cells if cell.strip()]
        if dialect.separator == BLANKS and not all(is_value(c, dialect.decimal) for c in full):
            continue  # texts may hold blanks
        widths[len(cells)] += 1
        values = sum(is_value(cell, dialect.decimal) for cell in full)
        of_numbers += len(cells) > 1 and values >= 0.5 * len(full) and bool(full)
    if not widths:
        return 0.0, 0.0, 0.0
    width, count = max((item for item in widths.items()), key=lambda item: (item[1], item[0]))
    if width < 2:
        return 0.0, 0.0, 0.0
    partly = _plain_share(dialect, lines)
    return of_numbers / len(lines) * partly, count / len(lines), min(width, 1000)


def _plain_share(dialect: Dialect, lines: Sequence[str]) -> float:
    """Return the share of cells that are values or texts without another separator."""
    cells = plain = 0
    for line in lines:
        for cell in dialect.split(line):
            if not cell.strip():
                continue
            cells += 1
            plain += is_value(cell, dialect.decimal) or not any(c in cell for c in "\t;,|")
    return plain / cells if cells else 0.0
