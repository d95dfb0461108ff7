"""``igrip evaluate``: the paper's evaluation of any dataset, with its figures."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

import typer

from igrip.cli.console import errors, output, print_json, progress
from igrip.config import Config
from igrip.errors import MissingExtraError, RecordingError
from igrip.grips import GRIPS
from igrip.io.datasets.dataset import Dataset
from igrip.io.datasets.participants import participants_without_trials
from igrip.lab.evaluation.experiment import Experiment
from igrip.objects.catalog import load_objects
from igrip.targets import TARGETS

USUAL = (
    "paper", "repaired", "bayes", "impacts", "distance_derivative", "distance", "future_distance",
)  # fmt: skip


def evaluate(
    dataset: Annotated[Path, typer.Argument(help="A dataset's folder.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder of the report.")],
    targets: Annotated[
        list[str] | None,
        typer.Option(help="Targets estimator; repeatable. Default: all that are known."),
    ] = None,
    grips: Annotated[
        str, typer.Option(help="Grip selector: contact, or cylinder (the paper's).")
    ] = Config().grips,
    objects: Annotated[
        list[str] | None,
        typer.Option(help="Where models come from, in place of the dataset's own."),
    ] = None,
    limit: Annotated[
        int, typer.Option(help="Only so many recordings, evenly spread; 0: all.", min=0)
    ] = 0,
    trial: Annotated[
        str | None, typer.Option(help="Recording of the time courses. Default: a typical one.")
    ] = None,
    jobs: Annotated[int, typer.Option(help="Processes; 0: one per processor.", min=0)] = 0,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit code 1 if a recording was excluded.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
) -> None:
    """Evaluate estimators over a dataset: summary.json, trials.parquet, report.html, figures.

    Interrupted, it goes on where it stopped when called again.

    Example: igrip evaluate cohort --out report --targets paper --targets repaired
    """
    try:
        from igrip.lab.evaluation.summary import frame_of, summarise
        from igrip.lab.report.page import write_report
    except ImportError as error:
        raise MissingExtraError("pandas", "report", "the evaluation") from error
    names = list(dict.fromkeys(targets or sorted(TARGETS.names(), key=_order)))
    for name in names:
        TARGETS.get(name)
    GRIPS.get(grips)
    opened = Dataset.open(dataset, lenient=True)
    chosen = list(opened.trials)
    if 0 < limit < len(chosen):
        chosen = [chosen[k * len(chosen) // limit] for k in range(limit)]
    if trial is not None and trial not in {t.recording for t in chosen}:
        raise RecordingError(f"{dataset}: no recording {trial!r} among those that are evaluated")
    experiment = Experiment(
        opened, [Config(targets=n, grips=grips) for n in names], out, objects or ()
    )
    with progress() as bar:
        task = bar.add_task(f"evaluating {opened.name}", total=len(chosen))
        for done in experiment.run(chosen, jobs or os.cpu_count() or 1):
            bar.update(task, completed=done)
    frame = frame_of(experiment.rows)
    summary = summarise(frame, opened.name, names)
    summary["without_trials"] = participants_without_trials(opened)
    with errors.status("writing the report …"):
        catalog = load_objects(*(objects or opened.objects))
        write_report(out, opened, catalog, frame, summary, trial)
    if trial in {told["recording"] for told in summary["excluded"]}:
        errors.print(f"{trial} was excluded, so its time courses are not drawn", style="yellow")
    _print(summary, out, as_json)
    if strict and summary["excluded"]:
        raise typer.Exit(1)


def _order(name: str) -> tuple[int, str]:
    return (USUAL.index(name) if name in USUAL else len(USUAL), name)


def _print(summary: dict[str, Any], out: Path, as_json: bool) -> None:
    for told in summary["excluded"]:
        errors.print(f"excluded {told['recording']}: {told['problem']}", style="yellow",
                     soft_wrap=True)  # fmt: skip
    for told in summary["remarks"]:
        errors.print(f"{told['recording']}: {told['remark']}", style="yellow", soft_wrap=True)
    for name in summary["without_trials"]:
        errors.print(f"participant {name} has no trials", style="yellow")
    if as_json:
        from igrip.lab.report.page import clean

        print_json(clean(summary))
        return
    from rich.table import Table
    from rich.text import Text

    from igrip.lab.report.page import percent, seconds

    table = Table(
        "targets", "valid: frames", "trials", "delay s", "margin s", "grip", "all: trials",
        "right at 40%", "at 60%",
    )  # fmt: skip
    for name, told in summary["targets"].items():
        valid, every = told["valid"], told["all"]
        accuracy = every.get("accuracy", {})
        table.add_row(
            Text(name, no_wrap=True), percent(valid.get("frames")), percent(valid.get("success")),
            seconds(valid.get("delay_s")), seconds(valid.get("margin_s")),
            percent(valid.get("grip_success")), percent(every.get("success")),
            percent(accuracy.get("40%")), percent(accuracy.get("60%")),
        )  # fmt: skip
    output.print(table)
    output.print(
        f"{summary['valid']} of {summary['reaches']} reaches valid, "
        f"{len(summary['excluded'])} recordings excluded; {out / 'report.html'}",
        soft_wrap=True,
    )
