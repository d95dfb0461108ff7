"""Tables that fold where the terminal is narrow, in place of cutting cells off."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, JustifyMethod, RenderResult
from rich.table import Table
from rich.text import Text

Cell = str | Text
PADDING, EDGE = 3, 1  # a column's two spaces and border; the border on the left
MIN_TEXT = 20  # characters of a column of text, where it is wrapped


class FoldingTable:
    """A table whose columns continue below, beside the leading ones again, where they do not fit.

    Numbers are never cut or broken. Text in a column that alone is wider than the terminal is
    wrapped.

    Parameters
    ----------
    columns : sequence of str
        Their titles.
    rows : iterable of sequences of str or Text
        The cells.
    title, caption : str
        Above and below.
    left : collection of int
        Columns of text, which stand on the left and may be wrapped; the first one always is.
    leading : int
        How many columns, from the first on, name a row and are repeated below.
    """

    def __init__(
        self, columns: Sequence[str], rows: Iterable[Sequence[Cell]], title: str = "",
        caption: str = "", left: Collection[int] = (), leading: int = 1,
    ) -> None:  # fmt: skip
        self.columns, self.rows = tuple(columns), [tuple(row) for row in rows]
        self.title, self.caption = title, caption
        self._left = {0, *left}
        self._leading = range(leading)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield as many tables as it takes."""
        if self.title:
            yield Text(self.title, "italic", overflow="fold")
        for widths in self._parts(options.max_width):
            table = Table()
            for k, width in widths.items():
                justify: JustifyMethod = "left" if k in self._left else "right"
                table.add_column(self.columns[k], justify=justify, overflow="fold", width=width)
            for row in self.rows:
                table.add_row(*(row[k] for k in widths))
            yield table
        if self.caption:
            yield Text(self.caption, overflow="fold")

    def _parts(self, available: int) -> Iterator[dict[int, int]]:
        """Yield the columns of each table that fits, with their widths [characters]."""
        natural = [
            max(cell_len(line) for row in (self.columns, *self.rows) for line in _lines(row[k]))
            for k in range(len(self.columns))
        ]
        smallest = [min(w, MIN_TEXT) if k in self._left else w for k, w in enumerate(natural)]
        part = [*self._leading]
        for k in range(len(part), len(natural)):
            used = EDGE + sum(smallest[n] + PADDING for n in (*part, k))
            if len(part) > len(self._leading) and used > available:
                yield self._spread(part, smallest, natural, available)
                part = [*self._leading]
            part.append(k)
        yield self._spread(part, smallest, natural, available)

    def _spread(
        self, part: Sequence[int], smallest: Sequence[int], natural: Sequence[int], available: int
    ) -> dict[int, int]:
        """Return the width of each column of a table; those of text share what is left over."""
        widths = {k: smallest[k] for k in part}
        left = available - EDGE - sum(width + PADDING for width in widths.values())
        for n, k in enumerate(wrapped := [k for k in part if smallest[k] < natural[k]]):
            more = max(0, min(natural[k] - widths[k], left // (len(wrapped) - n)))
            widths[k] += more
            left -= more
        return widths


def _lines(cell: Cell) -> list[str]:
    return str(cell).split("\n")
