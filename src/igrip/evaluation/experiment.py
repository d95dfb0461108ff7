"""An evaluation of any number of estimators over a dataset: parallel, and resumed if cut short."""

from __future__ import annotations

import hashlib
import json
import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from igrip.config import Config
from igrip.errors import IgripError, RecordingError
from igrip.estimator import Estimator
from igrip.evaluation.judging import NO_REACH, Seen, describe_trial, judge
from igrip.intention import Intention
from igrip.objects.catalog import Catalog, load_objects
from igrip.recording.dataset import Dataset, Trial
from igrip.recording.jsonl import JsonlReader
from igrip.version import __version__

Row = dict[str, Any]


def evaluate_trial(
    dataset: Dataset, trial: Trial, catalog: Catalog, configs: Sequence[Config]
) -> list[Row]:
    """Run estimators over one recording; one row each, with ``problem`` where that failed.

    A problem that leaves something to judge (a recording that is cut off, an object without a
    model) is named in the row as ``remark``, and the rest is judged.
    """
    base: Row = {
        "recording": trial.recording, "participant": trial.participant, "target": trial.target,
        "hand": trial.hand,
    }  # fmt: skip
    if trial.problem:
        return [base | {"targets": c.targets, "problem": trial.problem} for c in configs]
    estimators = [Estimator(catalog, config) for config in configs]
    said: list[list[Intention]] = [[] for _ in configs]
    seen = Seen(trial.hand, trial.target)
    problem: str | None = None
    cut: str | None = None
    try:
        reader = JsonlReader(dataset.recording(trial))
        for observation in reader:
            seen.take(observation)
            for estimator, intentions in zip(estimators, said, strict=True):
                intentions += estimator.update(observation)
        cut = reader.cut
    except IgripError as error:
        problem = str(error)
    bounds = seen.bounds(trial) if trial.target != NO_REACH else None
    problem = problem or _problem(trial, seen, bounds)
    inputs = estimators[0].inputs()["objects"]
    unknown = {f"{id}: {told['reason']}" for id, told in inputs.items() if not told["known"]}
    remarks = [*sorted(unknown), *_remarks(trial, seen), *([cut] if cut else [])]
    facts = describe_trial(trial, seen, bounds, estimators[0].objects)
    rows = []
    for config, intentions in zip(configs, said, strict=True):
        row = (
            base
            | facts
            | {"targets": config.targets, "problem": problem, "remark": "; ".join(remarks) or None}
        )
        rows.append(row if problem else row | judge(trial, bounds, intentions))
    return rows


def _problem(trial: Trial, seen: Seen, bounds: tuple[float, float] | None) -> str | None:
    """Say why a trial cannot be judged, in words."""
    if trial.target is None:
        return "its target is not known"
    if not seen.times:
        return "the recording is empty"
    if trial.target == NO_REACH:
        return None
    if trial.hand is None:
        return "its hand is not known"
    return None if bounds is not None else "its movement has no onset and end"


def _remarks(trial: Trial, seen: Seen) -> list[str]:
    """Say what was never seen: such a trial counts, and cannot be right."""
    if trial.target in (None, NO_REACH):
        return []
    told = [] if any(seen.hand) else [f"hand {trial.hand!r} was never seen"]
    return told + (
        [] if trial.target in seen.objects else [f"target {trial.target!r} never appears"]
    )


@dataclass(frozen=True)
class _Job:
    folder: Path
    trial: Trial
    configs: tuple[Config, ...]
    objects: tuple[str, ...]


_catalogs: dict[tuple[str, ...], Catalog] = {}  # one per process, since models take time to read
_datasets: dict[Path, Dataset] = {}


def _run_job(job: _Job) -> list[Row]:
    if job.objects not in _catalogs:
        _catalogs[job.objects] = load_objects(*job.objects)
    if job.folder not in _datasets:
        _datasets[job.folder] = Dataset.open(job.folder, lenient=True)
    return evaluate_trial(_datasets[job.folder], job.trial, _catalogs[job.objects], job.configs)


class Experiment:
    """Rows of an evaluation, kept in a file as they come.

    Parameters
    ----------
    dataset : Dataset
        What to evaluate on.
    configs : sequence of Config
        One per estimator.
    out : Path
        Folder of the report; ``rows.jsonl`` in it holds what is done.
    objects : sequence of str
        Sources of objects in place of the dataset's own.
    """

    def __init__(
        self, dataset: Dataset, configs: Sequence[Config], out: Path, objects: Sequence[str] = ()
    ) -> None:
        self._dataset, self._configs = dataset, tuple(configs)
        self._objects = tuple(objects) or dataset.objects
        self._path = out / "rows.jsonl"
        self._key = self._fingerprint()
        self.rows: list[Row] = []

    def _fingerprint(self) -> str:
        """Return a digest of all that the rows hang on."""
        digest = hashlib.sha256(__version__.encode())
        digest.update((self._dataset.path / "trials.tsv").read_bytes())
        for config in self._configs:
            digest.update(config.model_dump_json().encode())
        digest.update("\n".join(self._objects).encode())
        for path in sorted(Path(__file__).parents[1].rglob("*.py")):
            digest.update(path.read_bytes())  # another code, another answer
        return digest.hexdigest()[:16]

    def run(self, trials: Sequence[Trial], jobs: int) -> Iterator[int]:
        """Evaluate what is not done yet; yield how many trials are done."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        done = self._resume()
        left = [trial for trial in trials if trial.recording not in done]
        finished = len(trials) - len(left)
        yield finished
        work = [_Job(self._dataset.path, t, self._configs, self._objects) for t in left]
        try:
            with self._path.open("ab") as file:
                for rows in _results(work, min(jobs, max(1, len(work) // 10))):
                    for row in rows:
                        file.write(json.dumps(row, allow_nan=False).encode() + b"\n")
                    file.flush()
                    self.rows += rows
                    finished += 1
                    yield finished
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error

    def _resume(self) -> set[str]:
        """Read the rows of an earlier run of the same evaluation; return whose they are."""
        header = json.dumps({"evaluation": self._key}).encode() + b"\n"
        lines = self._path.read_bytes().split(b"\n") if self._path.exists() else []
        if not lines or lines[0] + b"\n" != header:
            self._path.write_bytes(header)
            return set()
        rows: list[Row] = []
        for line in lines[1:-1]:  # the last ends in the middle, or is empty
            try:
                rows.append(json.loads(line))
            except ValueError:
                break
        count: dict[str, int] = {}
        for row in rows:
            count[row["recording"]] = count.get(row["recording"], 0) + 1
        whole = {name for name, n in count.items() if n == len(self._configs)}
        self.rows = [row for row in rows if row["recording"] in whole]
        kept = b"".join(json.dumps(row).encode() + b"\n" for row in self.rows)
        self._path.write_bytes(header + kept)
        return whole


def _results(work: Sequence[_Job], jobs: int) -> Iterator[list[Row]]:
    if jobs <= 1:
        yield from map(_run_job, work)
        return
    context = multiprocessing.get_context("spawn")  # forking a process with threads is unsafe
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        yield from pool.map(_run_job, work, chunksize=max(1, min(20, len(work) // (8 * jobs))))
