"""``igrip bench``: how fast the estimator is on this machine."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from igrip.cli import options
from igrip.cli.console import errors, number, output, print_json, table_of, warn
from igrip.errors import install_command
from igrip.lab.speed import measure
from igrip.lab.speed.peers import TRIMESH, Recorded
from igrip.objects.catalog import load_objects

Frames = Annotated[int, typer.Option(help="Frames of each run.", min=20)]
Runs = Annotated[int, typer.Option(help="Runs; the best ratio counts.", min=1)]
PlainFrames = Annotated[
    int, typer.Option(help="Frames by trimesh without embree, which takes seconds each.", min=0)
]
Turn = Annotated[
    int, typer.Option(help="Frames that each does in a row; 1: caches are cold.", min=1)
]
Cadence = Annotated[float, typer.Option(help="Seconds at a real 30 Hz.", min=1.0)]
MemoryFrames = Annotated[
    int, typer.Option(help="Frames of the memory run; 0: leave it out.", min=0)
]


def bench(
    frames: Frames = 300,
    runs: Runs = 5,
    plain_frames: PlainFrames = 3,
    turn: Turn = 20,
    cadence: Cadence = 10.0,
    memory_frames: MemoryFrames = 0,
    as_json: options.Json = False,
) -> None:
    """Measure the speed of the estimator on this machine.

    Times of `update` in a row and at a real 30 Hz, with 4 and with 100 objects. Beside it, where
    they are installed (extra bench), the same rays by embreex and by trimesh
    without embree: ratios of medians, taken by turns in one run. More engines, growth and the
    picture: `python -m benchmarks` in a checkout.

    Example: igrip bench --runs 5 --memory-frames 200000
    """
    catalog = load_objects("ycb")
    report: dict[str, Any] = {"machine": measure.machine()}
    with errors.status("Timing beside other engines …") as status:
        recorded = Recorded.run(catalog, frames)
        report["peers"] = measure.compare(
            catalog, recorded, recorded.embree(), runs, plain_frames, turn
        )
        status.update("Timing at a real 30 Hz …")
        report["cadence_30_hz"] = measure.at_cadence(catalog, cadence)
        status.update("Timing with more objects …")
        rows = measure.growth_with_objects(catalog, (4, 100), frames, turn)
        report["growth"] = {"objects": rows}
        if memory_frames:
            status.update("Running for the memory …")
            report["memory"] = measure.memory(catalog, memory_frames)
    if as_json:
        print_json(report)
    else:
        print_report(report)


def print_report(report: dict[str, Any]) -> None:
    """Print what was measured, as tables."""
    machine = report["machine"]
    load = machine["load_average"]
    output.print(
        f"{machine['platform']}, Python {machine['python']}, {machine['processors']} processors"
        + (f", load average {load[0]:.2f}" if load else ""),
        soft_wrap=True,
    )
    peers = report["peers"]
    rows = dict(peers["best"])
    if peers["plain_trimesh"]:
        rows[TRIMESH] = peers["plain_trimesh"]
    rows["igrip, update at a real 30 Hz"] = report["cadence_30_hz"]
    output.print(
        table_of(
            ("2 hands, 4 objects of 16 k faces", "p50 ms", "p99 ms"),
            ((name, *_times(times)) for name, times in rows.items()),
        )
    )
    for name, ratio in peers["ratios"].items():
        of_runs = ", ".join(f"{r:.2f}" for r in peers["ratios_of_runs"].get(name, []))
        output.print(f"{name}: {ratio:.2f}" + (f" (runs: {of_runs})" if of_runs else ""))
    for problem in peers["missing"]:
        warn(f"left out: {problem} ({install_command('bench')})")
    for quantity, cases in report["growth"].items():
        columns = (quantity, "p50 ms", "p99 ms", "rays", "nodes, rays", "nodes, points")
        counts = ("rays", "ray_nodes", "point_nodes")
        cells = [
            (str(row["case"]), *_times(row), *(number(row[count], ".0f") for count in counts))
            for row in cases
        ]
        output.print(table_of(columns, cells))
    by_number = {row["case"]: row["p50_ms"] for row in report["growth"]["objects"]}
    output.print(f"100 objects / 4 objects: {by_number[100] / by_number[4]:.2f}")
    if "memory" in report:
        memory_run = report["memory"]
        output.print(
            f"memory: {memory_run['growth_mb']:+.2f} MB in the second half of "
            f"{memory_run['frames']} frames"
        )


def _times(row: Mapping[str, float]) -> tuple[str, str]:
    return number(row["p50_ms"], ".3f"), number(row["p99_ms"], ".3f")
