"""``python -m benchmarks``: what ``igrip bench`` measures, beside more peers, growth and bars."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from igrip.cli import bench, options
from igrip.cli.console import errors, output, print_json
from igrip.lab.speed import measure
from igrip.objects.catalog import load_objects

from . import picture, run

VERDICTS = {True: "yes", False: "no", None: "not judged: the machine is not idle"}


def main(
    frames: bench.Frames = 300,
    runs: bench.Runs = 5,
    plain_frames: bench.PlainFrames = 3,
    turn: bench.Turn = 20,
    cadence: bench.Cadence = 10.0,
    memory_frames: bench.MemoryFrames = 0,
    plot: Annotated[Path | None, typer.Option(help="Write the picture here (.png, .svg).")] = None,
    as_json: options.Json = False,
) -> None:
    """Measure the estimator beside every other engine, its growth, a replay, and the bars.

    Example: python -m benchmarks --memory-frames 200000 --plot bench.png
    """
    catalog = load_objects("ycb")
    report: dict[str, Any] = {"machine": measure.machine()}
    with errors.status("Timing beside other engines …") as status:
        report["peers"] = run.against_peers(catalog, frames, runs, plain_frames, turn)
        status.update("Timing at a real 30 Hz …")
        report["cadence_30_hz"] = measure.at_cadence(catalog, cadence)
        status.update("Timing with more objects, rays and faces …")
        report["growth"] = run.growth(catalog, frames, turn)
        status.update("Replaying a recording …")
        report["batch"] = run.batch(catalog, 10 * frames)
        if memory_frames:
            status.update("Running for the memory …")
            report["memory"] = measure.memory(catalog, memory_frames)
    report["bars"] = run.bars(report)
    if plot is not None:
        picture.draw(report, plot)
    if as_json:
        print_json(report)
        return
    bench.print_report(report)
    table = Table("what is aimed at", "bar", "measured", "reached")
    for row in report["bars"]:
        bar = f"≤ {row['max']:g}" if "max" in row else f"≥ {row['min']:g}"
        table.add_row(row["quantity"], bar, f"{row['measured']:.4g}", VERDICTS[row["reached"]])
    output.print(table)


if __name__ == "__main__":
    typer.run(main)
