"""Where the rows of a table end: sums, notes and blank lines below them are no data."""

from __future__ import annotations

from igrip.io.cells.dialect import is_value
from igrip.io.layouts import Head, Layout

MAX_FOOTER = 20  # lines


def without_footer(head: Head, layout: Layout) -> int:
    """Return the line behind the last row of data.

    Lines at the end whose first cell is a text, where it is a number in the first row of data, or
    that have another number of cells and few numbers, are a footer.
    """
    split, decimal = head.dialect.split, head.dialect.decimal
    stop, first = layout.stop, layout.first
    while stop > first and not head.lines[stop - 1].strip("\t ;,|\0"):
        stop -= 1
    if first >= stop:
        return stop
    model = split(head.lines[first])
    if not _numbers(model, decimal):
        return stop
    end = stop
    for index in range(stop - 1, max(first, stop - MAX_FOOTER), -1):
        cells = split(head.lines[index])
        starts_alike = is_value(cells[0], decimal) or not is_value(model[0], decimal)
        if cells and starts_alike and (_numbers(cells, decimal) or len(cells) == len(model)):
            continue
        end = index
    while end > first and not head.lines[end - 1].strip("\t ;,|\0"):
        end -= 1
    return end


def _numbers(cells: list[str], decimal: str) -> bool:
    full = [cell for cell in cells if cell.strip()]
    return bool(full) and sum(is_value(cell, decimal) for cell in full) >= 0.5 * len(full)
