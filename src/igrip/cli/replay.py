"""``igrip replay``: an estimator over a recording or a dataset."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.console import errors, output, print_json, progress
from igrip.cli.summaries import dataset_summary, print_dataset, print_recording, recording_summary
from igrip.config import Config
from igrip.errors import RecordingError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.io.datasets.dataset import Dataset
from igrip.io.recordings import open_source, open_writer
from igrip.lab.evaluation.replay import TrialResult, run_dataset
from igrip.objects.catalog import load_objects
from igrip.targets import TARGETS


def replay(
    recording: Annotated[
        Path, typer.Argument(help="A recording (.jsonl, .mcap) or a dataset's folder.")
    ],
    targets: Annotated[
        list[str] | None,
        typer.Option(help="Targets estimator; repeatable over a dataset. Default: the library's."),
    ] = None,
    objects: Annotated[
        list[str] | None,
        typer.Option(help="Where models come from, in place of the dataset's own or of ycb."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Write every intention to this .jsonl or .mcap."),
    ] = None,
    jobs: Annotated[int, typer.Option(help="Processes; 0: one per processor.", min=0)] = 0,
    limit: Annotated[
        int,
        typer.Option(help="Replay this many trials, evenly spread over the table; 0: all.", min=0),
    ] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for a program.")] = False,
) -> None:
    """Run an estimator over recordings and sum up what it said.

    Over a dataset: trial success and accuracy at 40 and 60 % of the movement, for each estimator.
    With --out, each line also says of which recording and estimator it is. Exit code 1 if some
    trials could not be read.

    Example: igrip replay near-far --targets paper --targets repaired
    """
    configs = [Config(targets=name) for name in targets or [Config().targets]]
    for config in configs:
        TARGETS.get(config.targets)
    if not recording.exists():
        raise RecordingError(f"{recording}: no such file or folder")
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
    with _writer(out) as write, progress() as bar:
        task = bar.add_task(f"replaying {path.name}", total=None)
        for observation in source:
            first = observation.t if not messages else first
            last, messages = observation.t, messages + 1
            for intention in estimator.update(observation):
                intentions.append(intention)
                write(intention)
            bar.advance(task)
    summary = recording_summary(str(path), config.targets, messages, last - first, intentions)
    cut = getattr(source, "cut", None)
    summary |= {"cut": cut, "inputs": estimator.inputs()}
    if as_json:
        print_json(summary)
    else:
        print_recording(output, summary)
    if cut:
        errors.print(cut, style="yellow", soft_wrap=True)


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
    begin = time.perf_counter()
    with _writer(out) as write, progress() as bar:
        task = bar.add_task(f"replaying {dataset.name}", total=len(trials))
        for done in run_dataset(dataset, configs, jobs, trials, objects, out is not None):
            for result, intentions in done:
                results.append(result)
                origin = {"recording": result.trial.recording, "targets": result.targets}
                for intention in intentions:
                    write(intention, **origin)
            bar.advance(task)
    elapsed = time.perf_counter() - begin
    summary = dataset_summary(dataset, results)
    recorded = sum(result.recorded for result in results)
    summary |= {"processes": jobs, "seconds": elapsed, "times_real_time": recorded / elapsed}
    if as_json:
        print_json(summary)
    else:
        print_dataset(output, summary)
    if summary["problems"]:
        raise typer.Exit(1)


@contextmanager
def _writer(path: Path | None) -> Iterator[Callable[..., object]]:
    """Open the file of the intentions before the long work, and write each as it comes."""
    if path is None:
        yield lambda intention, **origin: None
        return
    with open_writer(path) as file:
        yield file.write
