"""Where commands write: results to standard output, everything else to standard error."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any

from rich.console import Console

if TYPE_CHECKING:
    from igrip.cli.table import FoldingTable


class PipeConsole(Console):
    """A console that leaves it to the command's end what happens when its reader has gone."""

    def on_broken_pipe(self) -> None:
        """Raise the error again; rich would exit with code 1."""
        self._buffer.clear()
        raise


NOT_KEPT = "an unfinished dataset is not kept; the same command starts again"

# no markup: names and paths from outside may hold brackets
output = PipeConsole(markup=False, highlight=False)
errors = PipeConsole(stderr=True, markup=False, highlight=False)


def print_json(value: Any) -> None:
    """Print one JSON document for other programs."""
    print(json.dumps(value, indent=2, allow_nan=False))


def warn(text: str) -> None:
    """Print what the user should know, in yellow."""
    errors.print(text, style="yellow", soft_wrap=True)


def inform(text: str) -> None:
    """Print what is going on, dimmed."""
    errors.print(text, style="dim", soft_wrap=True)


def cluster_page(address: str) -> None:
    """Tell where the page of a Dask cluster is."""
    inform(f"the cluster's page: {address}")


def table_of(
    columns: Sequence[str], rows: Iterable[Sequence[Any]], title: str = "", caption: str = "",
    left: Collection[int] = (), leading: int = 1,
) -> FoldingTable:  # fmt: skip
    """Return a table that folds; the first column and those named stand on the left.

    The ``leading`` columns name a row, and are repeated wherever the table folds.
    """
    from igrip.cli.table import FoldingTable

    return FoldingTable(columns, rows, title, caption, left, leading)


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
def until_interrupted(kept: Callable[[], str] | str = "") -> Iterator[None]:
    """End the work inside at Ctrl-C, which is no error, and print what is kept."""
    try:
        yield
    except KeyboardInterrupt:
        text = kept if isinstance(kept, str) else kept()
        errors.print(f"stopped; {text}" if text else "stopped", soft_wrap=True)


@contextmanager
def interruptible(kept: Callable[[], str] | str) -> Iterator[None]:
    """At Ctrl-C within the work, end the command with a line on what is kept and how to go on."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        raise KeyboardInterrupt(kept if isinstance(kept, str) else kept()) from interrupt
