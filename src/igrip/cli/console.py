"""Where commands write: results to standard output, everything else to standard error."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any

from rich.console import Console

if TYPE_CHECKING:
    from rich.table import Table

# no markup: names and paths from outside may hold brackets
output = Console(markup=False, highlight=False)
errors = Console(stderr=True, markup=False, highlight=False)


def print_json(value: Any) -> None:
    """Print one JSON document for other programs."""
    print(json.dumps(value, indent=2, allow_nan=False))


def warn(text: str) -> None:
    """Print what the user should know, in yellow."""
    errors.print(text, style="yellow", soft_wrap=True)


def table_of(columns: Sequence[str], rows: Iterable[Sequence[Any]], title: str = "") -> Table:
    """Return a table; the first column stands on the left and is never shortened."""
    from rich.table import Table

    table = Table(title=title or None)
    for number, column in enumerate(columns):
        table.add_column(column, justify="right" if number else "left", no_wrap=not number)
    for row in rows:
        table.add_row(*row)
    return table


def number(value: float | None, form: str = ".2f", unit: str = "") -> str:
    """Return a number with its unit; a dash where it is unknown."""
    return "-" if value is None else f"{value:{form}}{unit}"


@contextmanager
def progress(description: str, total: int | None = None) -> Iterator[Callable[..., None]]:
    """Show a progress bar on standard error, if that is a terminal.

    The function that it yields is ``Progress.update`` of rich: ``advance``, ``completed``,
    ``total``.
    """
    from rich import progress as bars

    with bars.Progress(
        bars.TextColumn("{task.description}"),
        bars.BarColumn(),
        bars.MofNCompleteColumn(),
        bars.TimeElapsedColumn(),
        bars.TimeRemainingColumn(),
        console=errors,
        disable=not errors.is_terminal,
    ) as bar:
        yield partial(bar.update, bar.add_task(description, total=total))


@contextmanager
def until_interrupted() -> Iterator[None]:
    """End the work inside at Ctrl-C, which is no error."""
    try:
        yield
    except KeyboardInterrupt:
        errors.print("stopped")
