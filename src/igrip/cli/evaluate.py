"""``igrip evaluate``: the paper's evaluation of any dataset, with its figures."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from igrip.cli import options
from igrip.cli.console import (
    cluster_page,
    errors,
    interruptible,
    number,
    output,
    print_json,
    progress,
    table_of,
    warn,
)
from igrip.cli.estimator_setup import base_config, warm_up, with_targets
from igrip.cli.outputs import folder_option
from igrip.errors import RecordingError, requires_extra
from igrip.grips import GRIPS
from igrip.io.datasets.shared import open_dataset
from igrip.lab.evaluation.evaluation import Evaluation
from igrip.lab.evaluation.predicted_times import PARTS
from igrip.lab.evaluation.runner import spread
from igrip.lab.parallel import Workers, count_jobs
from igrip.targets import TARGETS

USUAL = (
    "paper", "repaired", "bayes", "impacts", "distance_derivative", "distance", "future_distance",
)  # fmt: skip


def evaluate(
    dataset: Annotated[Path, typer.Argument(help="A dataset's folder.")],
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="Folder of the report.", callback=folder_option()),
    ],
    targets: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{options.TARGETS_HELP} Repeatable. Default: all of them; with --config, the one "
            "it names."
        ),
    ] = None,
    config: options.ConfigFile = None,
    grips: Annotated[
        str | None,
        typer.Option(help="Grip selector: contact (default), or cylinder (the paper's)."),
    ] = None,
    objects: options.Objects = None,
    limit: options.Limit = 0,
    trial: Annotated[
        str | None, typer.Option(help="Recording of the time courses. Default: a typical one.")
    ] = None,
    jobs: options.Jobs = 0,
    scheduler: options.Scheduler = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit code 1 if a recording was excluded.")
    ] = False,
    as_json: options.Json = False,
) -> None:
    """Evaluate estimators over a dataset: summary.json, trials.parquet, report.html, figures.

    An interrupted evaluation continues where it stopped when the command is run again.

    Example: igrip evaluate cohort --out report --targets paper --targets repaired
    """
    base = base_config(config)
    named = targets or ([base.targets] if config is not None else TARGETS.names())
    names = list(dict.fromkeys(targets or sorted(named, key=_order)))
    for name in names:
        TARGETS.get(name)
    base = base.model_copy(update={"grips": grips or base.grips})
    GRIPS.get(base.grips)
    configs = [with_targets(base, name) for name in names]
    with requires_extra("pandas", "report", "the evaluation"):
        from igrip.lab.evaluation.summary import frame_of, summarise
        from igrip.lab.report.page import write_report
    opened = open_dataset(dataset, lenient=True)
    chosen = spread(opened.trials, limit)
    if trial is not None and trial not in {t.recording for t in chosen}:
        raise RecordingError(f"{dataset}: no recording {trial!r} among those that are evaluated")
    evaluation = Evaluation(opened, configs, out, objects or ())
    if scheduler is None and count_jobs(jobs, len(chosen)) > 1:
        for each in configs:
            warm_up(each, evaluation.catalog)  # once here, not in each process
    kept = f"what is done is kept in {out}; the same command goes on from there"
    with interruptible(kept), progress(f"evaluating {opened.name}", len(chosen)) as update:
        for done in evaluation.run(chosen, Workers(jobs, scheduler, cluster_page)):
            update(completed=done)
    frame = frame_of(evaluation.rows)
    summary = summarise(frame, opened.name, names)
    summary["without_trials"] = opened.participants_without_trials()
    with errors.status("writing the report …"):
        write_report(out, opened, evaluation.catalog, configs, frame, summary, trial, _typed())
    if trial in {row["recording"] for row in summary["excluded"]}:
        warn(f"{trial} was excluded, so its time courses are not drawn")
    _print(summary, out, as_json)
    excluded = summary["excluded"]
    nothing = len({row["recording"] for row in excluded}) == len(chosen)
    if nothing:
        warn(f"no trial could be scored; next: igrip check {dataset}")
    if nothing or (strict and excluded):
        raise typer.Exit(1)


def _typed() -> str:
    """Return the command as it was typed."""
    return shlex.join(["igrip", *sys.argv[1:]])


def _order(name: str) -> tuple[int, str]:
    return (USUAL.index(name) if name in USUAL else len(USUAL), name)


def _commitments(summary: dict[str, Any]) -> tuple[str, tuple[str, ...], list[Any]]:
    """Return title, columns and rows of the first commitments."""
    from igrip.lab.report.page import percent

    firsts = {name: s["first_commitments"]["all"] for name, s in summary["targets"].items()}
    rows = [
        (
            name, *(percent(first.get(key)) for key in ("committed", "right", "mean_part")),
            number(first.get("false_per_minute")),
        )
        for name, first in firsts.items() if first
    ]  # fmt: skip
    reliability = next((one["reliability"] for one in firsts.values() if one), None)
    columns = ("estimator", "committed", "right", "mean part", "false a minute")
    return f"First commitments, all trials, reliability {reliability}", columns, rows


def _times(summary: dict[str, Any]) -> tuple[str, tuple[str, ...], list[Any]]:
    """Return title, columns and rows of the predicted times."""
    from igrip.lab.report.page import error, percent

    def held(one: dict[str, Any]) -> str:
        return percent(one.get("held"))

    cells = (error, held)
    rows = [
        (name, event, *(cell(parts.get(f"{part:.0%}", {})) for part in PARTS for cell in cells))
        for name, scores in summary["targets"].items()
        for event, parts in scores["times"]["all"].items() if parts
    ]  # fmt: skip
    errors = (text for part in PARTS for text in (f"at {part:.0%}", "held"))
    columns = ("estimator", "event", *errors)
    title = "Predicted times: error in ms (median / 90 %), and what the 80 % intervals held"
    return title, columns, rows


def _print(summary: dict[str, Any], out: Path, as_json: bool) -> None:
    from igrip.lab.report.page import clean, percent, seconds

    notes = [f"excluded {row['recording']}: {row['problem']}" for row in summary["excluded"]]
    notes += [f"{row['recording']}: {row['remark']}" for row in summary["remarks"]]
    notes += [f"participant {name} has no trials" for name in summary["without_trials"]]
    for note in notes:
        warn(note)
    if as_json:
        print_json(clean(summary))
        return
    columns = (
        "estimator", "valid: frames", "trials", "delay s", "margin s", "grip", "all: trials",
        "right at 40%", "at 60%",
    )  # fmt: skip
    rows = []
    for name, scores in summary["targets"].items():
        valid, every = scores["valid"], scores["all"]
        accuracy = every.get("accuracy", {})
        rows.append((
            name, percent(valid["frames"]), percent(valid["success"]),
            seconds(valid["delay_s"]), seconds(valid["margin_s"]),
            percent(valid.get("grip_success")), percent(every["success"]),
            percent(accuracy.get("40%")), percent(accuracy.get("60%")),
        ))  # fmt: skip
    output.print(table_of(columns, rows))
    for title, heads, cells in (_commitments(summary), _times(summary)):
        if cells:
            output.print(table_of(heads, cells, title, leading=2 if "event" in heads else 1))
    output.print(
        f"{summary['valid']} of {summary['reaches']} reaches valid, "
        f"{len(summary['excluded'])} recordings excluded; {out / 'report.html'}",
        soft_wrap=True,
    )
