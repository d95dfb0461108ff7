"""Start-up times of two source trees: ``python -m benchmarks.startup OLD/src NEW/src``."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from igrip.cli.console import output, print_json
from igrip.lab.speed.timing import interleaved

STARTS = {
    "import igrip": ["-c", "import igrip"],
    "igrip --help": ["-m", "igrip", "--help"],
}


def start(tree: Path, arguments: list[str]) -> None:
    """Run Python once with a source tree, to the end."""
    environment = {**os.environ, "PYTHONPATH": str(tree.resolve())}
    subprocess.run([sys.executable, *arguments], env=environment, check=True, capture_output=True)


def main(
    old: Annotated[Path, typer.Argument(help="The src folder of one tree.")],
    new: Annotated[Path, typer.Argument(help="The src folder of the other.")],
    repeats: Annotated[int, typer.Option(help="Starts of each.", min=1)] = 11,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for a program.")] = False,
) -> None:
    """Time each start in both trees, by turns, and print the ratio of the medians."""
    report = {}
    for name, arguments in STARTS.items():
        contestants = {
            "old": lambda _, a=arguments: start(old, a),
            "new": lambda _, a=arguments: start(new, a),
        }
        interleaved(contestants, range(1))  # byte-compiles, and fills the disk's cache
        medians = {tree: float(np.median(s)) for tree, s in
                   interleaved(contestants, range(repeats)).items()}  # fmt: skip
        report[name] = {
            "old_s": medians["old"],
            "new_s": medians["new"],
            "ratio": medians["new"] / medians["old"],
        }
    if as_json:
        print_json(report)
        return
    for name, row in report.items():
        output.print(f"{name}: {row['old_s']:.2f} s → {row['new_s']:.2f} s, × {row['ratio']:.2f}")


if __name__ == "__main__":
    typer.run(main)
