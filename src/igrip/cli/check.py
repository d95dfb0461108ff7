"""``igrip check``: what is wrong with a dataset, trial by trial."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import errors, output, print_json, progress, table_of
from igrip.io.datasets.check import Flaw, check_trial, unused_recordings
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.objects.catalog import load_objects

MAX_ROWS = 200


def check(
    dataset: Annotated[Path, typer.Argument(help="A dataset's folder.")],
    objects: options.Objects = None,
    limit: options.Limit = 0,
    as_json: options.Json = False,
) -> None:
    """Check a dataset: every trial, its recording, hand, target and models.

    Exit code 1 if a trial cannot be scored. The format is described in docs/datasets.md.

    Example: igrip check cohort
    """
    opened = Dataset.open(dataset, lenient=True)
    models = load_objects(*(objects or opened.objects))
    count = min(limit or len(opened.trials), len(opened.trials))
    chosen = [opened.trials[k * len(opened.trials) // count] for k in range(count)]
    found: list[tuple[Trial, list[Flaw]]] = []
    with progress(f"checking {opened.name}", len(chosen)) as update:
        for trial in chosen:
            found.append((trial, check_trial(opened, trial, models)))
            update(advance=1)
    unused = unused_recordings(opened)
    failed = sum(any(flaw.verdict == "error" for flaw in flaws) for _, flaws in found)
    if as_json:
        print_json(
            {
                "dataset": str(dataset),
                "trials": len(found),
                "failed": failed,
                "unused_recordings": unused,
                "frame": opened.frame.to_dict(),
                "flaws": [
                    {"recording": trial.recording, **flaw._asdict()}
                    for trial, flaws in found
                    for flaw in flaws
                ],
            }
        )
    else:
        _print(opened, found, failed, unused)
    if failed:
        raise typer.Exit(1)


def _print(
    dataset: Dataset, found: list[tuple[Trial, list[Flaw]]], failed: int, unused: list[str]
) -> None:
    rows = [(trial.recording, flaw.verdict, flaw.text) for trial, flaws in found for flaw in flaws]
    if rows:
        output.print(table_of(("recording", "", "what"), rows[:MAX_ROWS], left=(1, 2)))
    if len(rows) > MAX_ROWS:
        output.print(f"… and {len(rows) - MAX_ROWS} more; --json lists all")
    if unused:
        more = f" and {len(unused) - 5} more" if len(unused) > 5 else ""
        output.print(f"recordings that no trial names: {', '.join(unused[:5])}{more}")
    output.print(f"{dataset.name}: {len(found) - failed} of {len(found)} trials can be scored")
    if failed:
        errors.print(
            "Next: correct trials.tsv or the recordings; docs/datasets.md names each field"
        )
