"""The table of ``igrip live``: rates and latencies of each stage, and each hand in a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from igrip.cli.console import number, table_of
from igrip.cli.table import FoldingTable
from igrip.describe import describe
from igrip.intention import Intention

COLUMNS = ("stage", "frames/s", "age", "duration", "skipped", "failed")


def rows_of(report: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """Return the cells of a row for each stage of a pipeline's report."""
    return [
        (
            name,
            number(stage.get("rate", 0.0), ".1f"),
            number(stage.get("age_p50_ms"), ".0f", " ms"),
            number(stage.get("duration_p50_ms"), ".0f", " ms"),
            str(stage.get("skipped", "-")),
            str(stage.get("failed", "-")),
        )
        for name, stage in report.items()
    ]


def live_table(
    t: float, report: Mapping[str, Mapping[str, Any]], intentions: Sequence[Intention]
) -> FoldingTable:
    """Return the table for the terminal."""
    caption = "\n".join(describe(intention) for intention in intentions) or "no hand yet"
    return table_of(COLUMNS, rows_of(report), f"t = {t:.1f} s", caption)
