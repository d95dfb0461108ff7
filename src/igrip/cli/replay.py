"""``igrip replay``: estimators over a recording or a dataset."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import interruptible, output, print_json, progress, warn
from igrip.cli.estimator_setup import base_config, warm_up, with_targets
from igrip.cli.outputs import check_file, file_option
from igrip.cli.summaries import MAX_LINES, print_dataset, print_recording, recording_summary
from igrip.config import Config
from igrip.errors import RecordingError
from igrip.io.datasets.dataset import Dataset
from igrip.io.defects import DefectCounts
from igrip.io.frames import DeclaredFrame
from igrip.io.intention_files import ENDINGS, open_intention_writer
from igrip.io.recordings import open_source
from igrip.io.ros2.storage import is_bag
from igrip.lab.evaluation.replay import ReplayedTrial, replay_run, summarise_replay
from igrip.lab.evaluation.runner import EstimatorRun, run_trials, spread
from igrip.lab.parallel import Workers, count_jobs
from igrip.lab.report.probability_figure import plot_probability
from igrip.objects.catalog import load_objects


def replay(
    recording: Annotated[
        Path,
        typer.Argument(
            help="A recording (.jsonl, .mcap), a bag of ROS 2 (.mcap, .db3, folder), or a "
            "dataset's folder."
        ),
    ],
    targets: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{options.TARGETS_HELP} Repeatable over a dataset. Default: the library's, bayes."
        ),
    ] = None,
    config: options.ConfigFile = None,
    objects: options.Objects = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Write every intention to this .jsonl or .mcap, or as a "
                     "table to this .csv or .parquet."),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(help="Of a single recording: draw the probabilities over time (.png, .svg, "
                     ".pdf).", callback=file_option(".png", ".svg", ".pdf")),
    ] = None,
    jobs: options.Jobs = 0,
    limit: options.Limit = 0,
    as_json: options.Json = False,
    up: options.Up = None,
    axes: options.Axes = None,
    handedness: options.Handedness = None,
    quaternions: options.Quaternions = "xyzw",
    length_unit: options.LengthUnit = "m",
    time_unit: options.TimeUnit = "s",
) -> None:  # fmt: skip
    """Run estimators over recordings and summarise their predictions.

    Over a dataset: trial success and accuracy at 40 and 60 % of the movement for each estimator,
    over all trials as in `igrip evaluate`. With --out, each line also names its recording and
    estimator. Exit code 1 if some trials could not be scored.

    A single recording of another frame or other units is converted: --up y --time-unit ms.

    Example: igrip replay near-far --targets paper --targets repaired

    Example: igrip replay reach.jsonl --out intentions.csv --plot probability.svg
    """
    base = base_config(config)
    configs = [with_targets(base, name) for name in targets or [base.targets]]
    if out is not None:
        named = str(out).partition(":")  # jsonl:/dev/stdout has no ending
        is_named = named[0] in ("jsonl", "mcap") and bool(named[1])
        check_file(Path(named[2]) if is_named else out, () if is_named else ENDINGS)
    if not recording.exists():
        raise RecordingError(f"{recording}: no such file or folder")
    frame = DeclaredFrame.declare(up, axes, handedness, quaternions, length_unit, time_unit)
    if recording.is_dir() and not is_bag(recording):
        if not frame.is_default:
            raise RecordingError("frame and units of a dataset are declared in its dataset.json")
        if plot is not None:
            raise RecordingError("--plot draws a single recording; see docs/tables.md")
        _replay_dataset(recording, configs, objects or [], out, jobs, limit, as_json)
    elif len(configs) > 1:
        raise RecordingError("name only one estimator for a single recording")
    else:
        _replay_recording(recording, configs[0], objects or ["ycb"], out, plot, as_json, frame)


def _replay_recording(
    path: Path, config: Config, objects: list[str], out: Path | None, plot: Path | None,
    as_json: bool, frame: DeclaredFrame,
) -> None:  # fmt: skip
    source = open_source(path, frame)
    run = EstimatorRun(load_objects(*objects), config)
    times = []
    origin = {"recording": path.name, "targets": config.targets}
    with _writer(out, **origin) as write, progress(f"replaying {path.name}") as update:
        for observation in source:
            times.append(observation.t)
            for intention in run.update(observation):
                write(intention)
            update(advance=1)
    if not times:
        raise RecordingError(f"{path}: holds no messages")
    if plot is not None:
        plot_probability(run.intentions, plot)
    seconds = times[-1] - times[0]
    summary = recording_summary(str(path), config.targets, len(times), seconds, run.intentions)
    cut, defects = getattr(source, "cut", None), getattr(source, "defects", DefectCounts())
    remarks = [*getattr(source, "remarks", []), *_missing(run)]
    summary |= {
        "cut": cut, "defects": defects.report(), "remarks": remarks,
        "inputs": run.estimator.inputs(),
    }  # fmt: skip
    if as_json:
        print_json(summary)
    else:
        print_recording(output, summary)
    for text in [*([cut] if cut else []), *remarks, *defects.lines()]:
        warn(text)
    inputs = run.estimator.inputs()
    if not inputs["hands"]:
        none = "no hand" if inputs["objects"] else "no hand and no object"
        raise RecordingError(
            f"{path}: {none} in {len(times)} messages: there is nothing to predict"
        )


def _missing(run: EstimatorRun) -> list[str]:
    """Return what a recording lacks for any prediction, as text."""
    inputs = run.estimator.inputs()
    remarks = [f"{id}: {state['reason']}" for id, state in inputs["objects"].items()
               if not state["known"]]  # fmt: skip
    if inputs["hands"] and not inputs["objects"]:
        remarks.append("no object was seen: there is no target to choose")
    return remarks


def _replay_dataset(
    path: Path,
    configs: list[Config],
    objects: list[str],
    out: Path | None,
    jobs: int,
    limit: int,
    as_json: bool,
) -> None:
    dataset = Dataset.open(path)
    catalog = load_objects(*(objects or dataset.objects))
    trials = spread(dataset.trials, limit)
    jobs = count_jobs(jobs, len(trials))
    analyse = partial(replay_run, keep_intentions=out is not None)
    replayed: list[ReplayedTrial] = []
    begin = time.perf_counter()
    if jobs > 1:
        for config in configs:
            warm_up(config, catalog)  # once here, not in each process
    with _writer(out) as write, progress(f"replaying {dataset.name}", len(trials)) as update:
        for done in run_trials(dataset, catalog, configs, analyse, trials, Workers(jobs)):
            for row, intentions in zip(done.rows, done.intentions, strict=True):
                for intention in intentions:
                    write(intention, recording=row["recording"], targets=row["targets"])
            replayed.append(done._replace(intentions=[]))
            update(advance=1)
    elapsed = time.perf_counter() - begin
    summary = summarise_replay(dataset, replayed)
    recorded = sum(row.get("seconds", 0.0) for trial in replayed for row in trial.rows)
    summary |= {"processes": jobs, "seconds": elapsed, "times_real_time": recorded / elapsed}
    if as_json:
        print_json(summary)
        for text in sorted({row["remark"] for row in summary["remarks"]})[:MAX_LINES]:
            warn(text)
    else:
        print_dataset(output, summary)
    nothing = not any(row["trials"] for row in summary["results"])
    if nothing:
        warn(f"no trial could be scored; next: igrip check {path}")
    if nothing or summary["problems"]:
        raise typer.Exit(1)


@contextmanager
def _writer(path: Path | None, **origin: str) -> Iterator[Callable[..., object]]:
    """Open the file of the intentions before the long work, and write each as it comes."""
    if path is None:
        yield lambda intention, **origin: None
        return
    kept = f"the intentions until now are in {path}; run again to replace them by all"
    with interruptible(kept), open_intention_writer(path, **origin) as file:
        yield file.write
