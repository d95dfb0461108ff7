"""``igrip bench``: how fast the estimator is on this machine, beside other engines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from igrip.benchmark import picture, run
from igrip.cli.console import errors, output, print_json
from igrip.objects.catalog import load_objects

VERDICTS = {True: "yes", False: "no", None: "not judged: the machine is not idle"}


def bench(
    frames: Annotated[int, typer.Option(help="Frames of each run.", min=20)] = 300,
    runs: Annotated[int, typer.Option(help="Runs; the best ratio counts.", min=1)] = 5,
    plain_frames: Annotated[
        int, typer.Option(help="Frames by trimesh without embree, which takes seconds each.", min=0)
    ] = 3,
    turn: Annotated[
        int, typer.Option(help="Frames that each does in a row; 1: caches are cold.", min=1)
    ] = 20,
    cadence: Annotated[float, typer.Option(help="Seconds at a real 30 Hz.", min=1.0)] = 10.0,
    memory_frames: Annotated[
        int, typer.Option(help="Frames of the memory run; 0: leave it out.", min=0)
    ] = 0,
    plot: Annotated[Path | None, typer.Option(help="Write the picture here (.png, .svg).")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for a program.")] = False,
) -> None:
    """Measure the speed of `update` here: ratios of medians, taken in turn in one run.

    Beside it, where they are installed (pip install 'igrip[bench]'): the same rays by embreex
    alone, a frame by embreex + numpy + scipy, and, afterwards, trimesh without embree.

    Example: igrip bench --runs 5 --memory-frames 200000 --plot bench.png
    """
    catalog = load_objects("ycb")
    report: dict[str, Any] = {"machine": run.machine()}
    with errors.status("timing beside other engines …") as status:
        report["peers"] = run.against_peers(catalog, frames, runs, plain_frames, turn)
        status.update("timing at a real 30 Hz …")
        report["cadence_30_hz"] = run.at_cadence(catalog, cadence)
        status.update("timing with more objects, rays and faces …")
        report["growth"] = run.growth(catalog, frames, turn)
        status.update("replaying a recording …")
        report["batch"] = run.batch(catalog, 10 * frames)
        if memory_frames:
            status.update("running for the memory …")
            report["memory"] = run.memory(catalog, memory_frames)
    report["bars"] = run.bars(report)
    if plot is not None:
        picture.draw(report, plot)
    if as_json:
        print_json(report)
    else:
        _print(report)


def _print(report: dict[str, Any]) -> None:
    told = report["machine"]
    load = told["load_average"]
    output.print(
        f"{told['platform']}, Python {told['python']}, {told['processors']} processors"
        + (f", load average {load[0]:.2f}" if load else ""),
        soft_wrap=True,
    )
    peers = report["peers"]
    rows = dict(peers["best"])
    if peers["plain_trimesh"]:
        rows["trimesh without embree, rays alone"] = peers["plain_trimesh"]
    rows["igrip, update at a real 30 Hz"] = report["cadence_30_hz"]
    table = Table("2 hands, 4 objects of 16 k faces", "p50 ms", "p99 ms")
    for name, times in rows.items():
        table.add_row(name, f"{times['p50_ms']:.3f}", f"{times['p99_ms']:.3f}")
    output.print(table)
    for name, ratio in peers["ratios"].items():
        of_runs = ", ".join(f"{r:.2f}" for r in peers["ratios_of_runs"].get(name, []))
        output.print(f"{name}: {ratio:.2f}" + (f" (runs: {of_runs})" if of_runs else ""))
    for package in peers["missing"]:
        errors.print(f"left out: {package} (pip install 'igrip[bench]')", style="yellow")
    for what, cases in report["growth"].items():
        table = Table(what, "p50 ms", "p99 ms", "rays", "nodes, rays", "nodes, points")
        for row in cases:
            counts = (row["rays"], row["ray_nodes"], row["point_nodes"])
            table.add_row(
                str(row["case"]),
                f"{row['p50_ms']:.3f}",
                f"{row['p99_ms']:.3f}",
                *(f"{count:.0f}" for count in counts),
            )
        output.print(table)
    table = Table("what is aimed at", "bar", "measured", "reached")
    for row in report["bars"]:
        bar = f"≤ {row['most']:g}" if "most" in row else f"≥ {row['least']:g}"
        table.add_row(row["what"], bar, f"{row['measured']:.4g}", VERDICTS[row["reached"]])
    output.print(table)
    if "memory" in report:
        grown = report["memory"]
        output.print(
            f"memory: {grown['growth_mb']:+.2f} MB in the second half of {grown['frames']} frames"
        )
