"""``igrip export``: a dataset in another format."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import NOT_KEPT, interruptible, output, print_json, progress, warn
from igrip.cli.outputs import folder_option
from igrip.io.datasets.dataset import Dataset
from igrip.io.exporters import EXPORTERS


def export(
    dataset: Annotated[Path, typer.Argument(help="A dataset's folder, or a study's.")],
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="New folder.", callback=folder_option(new=True)),
    ],
    format: Annotated[
        str, typer.Option("--format", help=f"One of: {', '.join(EXPORTERS.names())}.")
    ] = "motion_bids",
    as_json: options.Json = False,
) -> None:
    """Write a dataset in another format, to publish it or to read it elsewhere.

    What could name a person stays out of motion_bids: dates, consent and comments.

    Example: igrip export my-study --out my-study-bids

    Example: igrip export my-study --format csv --out my-study-csv
    """
    write = EXPORTERS.get(format)
    opened = Dataset.open(dataset)
    out.parent.mkdir(parents=True, exist_ok=True)
    unfinished = Path(tempfile.mkdtemp(dir=out.parent, prefix=f".{out.name}-"))
    try:
        with (
            interruptible(NOT_KEPT),
            progress(f"exporting {opened.name}", len(opened.trials)) as update,
        ):
            problems = write(opened, unfinished, lambda: update(advance=1))
        unfinished.chmod(0o755)  # a temporary folder is private
        os.replace(unfinished, out)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)
    for problem in problems:
        warn(f"left out: {problem}")
    written = len(opened.trials) - len(problems)
    if as_json:
        print_json({"folder": str(out), "recordings": written, "left_out": problems})
    else:
        output.print(f"{written} recordings in {out}", soft_wrap=True)
