"""Where the commands write: answers to standard output, everything else to standard error."""

from __future__ import annotations

import json
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

# no markup: names and paths come from outside, and may hold brackets
output = Console(markup=False, highlight=False)
errors = Console(stderr=True, markup=False, highlight=False)


def print_json(value: Any) -> None:
    """Print one JSON document for a program to read."""
    print(json.dumps(value, indent=2, allow_nan=False))


def progress() -> Progress:
    """Return a progress bar on standard error; it draws nothing where that is no terminal."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=errors,
        disable=not errors.is_terminal,
    )
