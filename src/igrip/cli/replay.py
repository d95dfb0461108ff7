"""``igrip replay``: an estimator over a recording or a dataset."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.console import errors, output, print_json, progress
from igrip.cli.summaries import dataset_summary, print_dataset, print_recording, recording_summary
from igrip.config import Config
from igrip.errors import RecordingError
from igrip.estimator import Estimator
from igrip.evaluation.replay import TrialResult, run_dataset
from igrip.intention import Intention
from igrip.objects.catalog import load_objects
from igrip.recording.dataset import Dataset
from igrip.recording.jsonl import JsonlReader, JsonlWriter
from igrip.sources.base import open_source
from igrip.targets import TARGETS


def replay(
    recording: Annotated[Path, typer.Argument(help="A recording (.jsonl) or a dataset's folder.")],
    targets: Annotated[
        list[str] | None,
        typer.Option(help="Targets estimator; repeatable over a dataset. Default: the library's."),
    ] = None,
    objects: Annotated[
        list[str] | None,
        typer.Option(help="Where models come from, in place of the dataset's own or of ycb."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Write every intention to this .jsonl.")
    ] = None,
    jobs: Annotated[int, typer.Option(help="Processes; 0: one per processor.")] = 0,
    limit: Annotated[
        int, typer.Option(help="Replay this many trials, evenly spread over the table; 0: all.")
    ] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for a program.")] = False,
) -> None:
    """Run an estimator over recordings and sum up what it said.

    Over a dataset: trial success and accuracy at 40 and 60 % of the movement, for each estimator.
    Exit code 1 if some trials could not be read.

    Example: igrip replay near-far --targets paper --targets repaired
    """
    configs = [Config(targets=name) for name in targets or [Config().targets]]
    for config in configs:
        TARGETS.get(config.targets)
    if recording.is_dir():
        _replay_dataset(recording, configs, objects or [], out, jobs, limit, as_json)
        return
    if len(configs) > 1:
        raise RecordingError("one estimator at a time over a single recording, please")
    _replay_recording(recording, configs[0], objects or ["ycb"], out, as_json)


def _replay_recording(
    path: Path, config: Config, objects: list[str], out: Path | None, as_json: bool
) -> None:
    source = open_source(path)
    estimator = Estimator(load_objects(*objects), config)
    intentions: list[Intention] = []
    messages, first, last = 0, 0.0, 0.0
    with progress() as bar:
        task = bar.add_task(f"replaying {path.name}", total=None)
        for observation in source:
            first = observation.t if not messages else first
            last, messages = observation.t, messages + 1
            intentions += estimator.update(observation)
            bar.advance(task)
    cut = source.cut if isinstance(source, JsonlReader) else None
    if cut:
        errors.print(f"[yellow]{cut}[/]", highlight=False, soft_wrap=True)
    if out is not None:
        _write(out, intentions)
    summary = recording_summary(str(path), config.targets, messages, last - first, intentions)
    summary |= {"cut": cut, "inputs": estimator.inputs()}
    if as_json:
        print_json(summary)
    else:
        print_recording(output, summary)


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
    trials = list(dataset.trials)
    if 0 < limit < len(trials):
        trials = [trials[k * len(trials) // limit] for k in range(limit)]
    jobs = min(jobs or os.cpu_count() or 1, max(1, len(trials) // 20))
    results: list[TrialResult] = []
    kept: list[Intention] = []
    begin = time.perf_counter()
    with progress() as bar:
        task = bar.add_task(f"replaying {dataset.name}", total=len(trials))
        for done in run_dataset(dataset, configs, jobs, trials, objects, out is not None):
            for result, intentions in done:
                results.append(result)
                kept += intentions
            bar.advance(task)
    elapsed = time.perf_counter() - begin
    if out is not None:
        _write(out, kept)
    summary = dataset_summary(dataset, results)
    recorded = sum(result.recorded for result in results)
    summary |= {"processes": jobs, "seconds": elapsed, "times_real_time": recorded / elapsed}
    if as_json:
        print_json(summary)
    else:
        print_dataset(output, summary)
    if summary["problems"]:
        raise typer.Exit(1)


def _write(path: Path, intentions: list[Intention]) -> None:
    with JsonlWriter(path) as file:
        for intention in intentions:
            file.write(intention)
