"""Runs an estimator over the trials of a dataset: the same ``update`` as live."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from igrip.config import Config
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.recordings import open_source
from igrip.lab.evaluation.processes import in_processes
from igrip.lab.evaluation.trials import TrialScore, causal_accuracy, score_trial
from igrip.objects.catalog import Catalog, load_objects

FRACTIONS = (0.4, 0.6)
NEVER = "none"


@dataclass(frozen=True)
class TrialResult:
    """What one estimator did in one trial.

    Attributes
    ----------
    targets : str
        Name of the estimator.
    trial : Trial
        The row of ``trials.tsv``.
    frames : int
        Answers for the task's hand.
    score : TrialScore or None
        None where there is no target to compare with, or ``problem`` says why.
    accurate : tuple of bool
        Whether it was right at each of :data:`FRACTIONS` of the movement.
    recorded : float
        Length of the recording [s].
    cut : str or None
        Where the recording was cut off.
    problem : str or None
        What is wrong with the trial.
    """

    targets: str
    trial: Trial
    frames: int = 0
    score: TrialScore | None = None
    accurate: tuple[bool, ...] = ()
    recorded: float = 0.0
    cut: str | None = None
    problem: str | None = None


def run_trial(
    dataset: Dataset, trial: Trial, catalog: Catalog, config: Config
) -> tuple[TrialResult, list[Intention]]:
    """Run one estimator over one recording and score it against the row of the trial."""
    intentions: list[Intention] = []
    seen: set[str] = set()
    first = last = 0.0
    result = TrialResult(config.targets, trial)
    try:
        reader = open_source(dataset.recording(trial))
        estimator = Estimator(catalog, config)
        for number, observation in enumerate(reader):
            first = observation.t if number == 0 else first
            last = observation.t
            seen.update(observation.objects)
            intentions += estimator.update(observation)
    except IgripError as error:
        return replace(result, problem=str(error)), intentions
    own = [intention for intention in intentions if intention.hand == trial.hand]
    result = replace(
        result, frames=len(own), recorded=last - first, cut=getattr(reader, "cut", None)
    )
    if trial.target in (None, NEVER):
        return result, intentions  # nothing to compare with, and nothing wrong
    if trial.onset_s is None or trial.end_s is None:
        return replace(result, problem="onset and end are not known"), intentions
    if not own:
        return replace(result, problem=f"hand {trial.hand!r} was never seen"), intentions
    if trial.target not in seen:
        return replace(result, problem=f"target {trial.target!r} never appears"), intentions
    times = np.array([intention.t for intention in own])
    correct = np.array([intention.target == trial.target for intention in own])
    score = score_trial(times, correct, trial.onset_s, trial.end_s)
    accurate = causal_accuracy(times, correct, trial.onset_s, trial.end_s, FRACTIONS)
    return replace(result, score=score, accurate=tuple(accurate.tolist())), intentions


@dataclass(frozen=True)
class _Job:
    """One trial for one process; small, since it is sent there."""

    folder: Path
    trial: Trial
    configs: tuple[Config, ...]
    objects: tuple[str, ...]
    keep: bool


_catalogs: dict[tuple[str, ...], Catalog] = {}  # one per process, since models take time to read
_datasets: dict[Path, Dataset] = {}


def _run_job(job: _Job) -> list[tuple[TrialResult, list[Intention]]]:
    if job.objects not in _catalogs:
        _catalogs[job.objects] = load_objects(*job.objects)
    if job.folder not in _datasets:
        _datasets[job.folder] = Dataset.open(job.folder)
    done = []
    for config in job.configs:
        result, intentions = run_trial(
            _datasets[job.folder], job.trial, _catalogs[job.objects], config
        )
        done.append((result, intentions if job.keep else []))
    return done


def run_dataset(
    dataset: Dataset,
    configs: Sequence[Config],
    jobs: int = 1,
    trials: Sequence[Trial] | None = None,
    objects: Sequence[str] = (),
    keep_intentions: bool = False,
) -> Iterator[list[tuple[TrialResult, list[Intention]]]]:
    """Run estimators over the trials of a dataset, in parallel processes, in order.

    Parameters
    ----------
    dataset : Dataset
        What to run over.
    configs : sequence of Config
        One per estimator.
    jobs : int
        Number of processes.
    trials : sequence of Trial, optional
        Some of the dataset's trials; by default all.
    objects : sequence of str, optional
        Sources of objects in place of the dataset's own.
    keep_intentions : bool
        Whether the intentions are wanted as well.

    Yields
    ------
    list of (TrialResult, list of Intention)
        For each trial, one entry per estimator.
    """
    sources = tuple(objects) or dataset.objects
    work = [
        _Job(dataset.path, trial, tuple(configs), sources, keep_intentions)
        for trial in (dataset.trials if trials is None else trials)
    ]
    yield from in_processes(_run_job, work, jobs)
