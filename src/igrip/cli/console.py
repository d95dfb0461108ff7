"""Where commands write: results to standard output, everything else to standard error."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from rich.console import Console

if TYPE_CHECKING:
    from rich.progress import Progress

# no markup: names and paths from outside may hold brackets
output = Console(markup=False, highlight=False)
errors = Console(stderr=True, markup=False, highlight=False)


def print_json(value: Any) -> None:
    """Print one JSON document for other programs."""
    print(json.dumps(value, indent=2, allow_nan=False))


def progress() -> Progress:
    """Return a progress bar on standard error; it draws nothing if that is not a terminal."""
    from rich import progress as bars

    return bars.Progress(
        bars.TextColumn("{task.description}"),
        bars.BarColumn(),
        bars.MofNCompleteColumn(),
        bars.TimeElapsedColumn(),
        bars.TimeRemainingColumn(),
        console=errors,
        disable=not errors.is_terminal,
    )
