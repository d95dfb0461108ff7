"""The table of ``igrip live``: rates and latencies of each stage, and each hand in a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.table import Table

from igrip.describe import describe
from igrip.intention import Intention

COLUMNS = ("stage", "frames/s", "age", "duration", "skipped", "failed")


def rows_of(report: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """Return the cells of a row for each stage of a pipeline's report."""
    return [
        (
            name,
            f"{stage.get('rate', 0.0):.1f}",
            _milliseconds(stage.get("age_p50_ms")),
            _milliseconds(stage.get("duration_p50_ms")),
            str(stage.get("skipped", "-")),
            str(stage.get("failed", "-")),
        )
        for name, stage in report.items()
    ]


def table_of(
    t: float, report: Mapping[str, Mapping[str, Any]], intentions: Sequence[Intention]
) -> Table:
    """Return the table for the terminal."""
    table = Table(title=f"t = {t:.1f} s")
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "stage" else "right")
    for row in rows_of(report):
        table.add_row(*row)
    table.caption = "\n".join(describe(intention) for intention in intentions) or "no hand yet"
    table.caption_justify = "left"
    return table


def markdown_of(report: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the table for the page, in Markdown."""
    lines = [" | ".join(COLUMNS), " | ".join("---" for _ in COLUMNS)]
    lines += [" | ".join(row) for row in rows_of(report)]
    return "\n".join(f"| {line} |" for line in lines)


def _milliseconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.0f} ms"
