"""An evaluation of any number of estimators over a dataset: parallel, and resumed if cut short."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from igrip.config import Config
from igrip.errors import IgripError, RecordingError
from igrip.estimator import Estimator
from igrip.geometry.scene import PlacedObject
from igrip.intention import Intention
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.recordings import open_source
from igrip.lab.evaluation.commitments import Curve, judge_commitments
from igrip.lab.evaluation.processes import in_processes
from igrip.lab.evaluation.trial_metrics import NO_REACH, Seen, coverage, describe_trial, judge
from igrip.objects.catalog import Catalog, load_objects
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
    curves = [Curve(config.commitment) for config in configs]
    seen = Seen(trial.hand, trial.target)
    layout: list[PlacedObject] = []  # of the objects when the movement began
    problem: str | None = None
    cut: str | None = None
    try:
        reader = open_source(dataset.recording(trial))
        for observation in reader:
            seen.take(observation)
            for estimator, intentions, curve in zip(estimators, said, curves, strict=True):
                intentions += estimator.update(observation)
                curve.take(estimator.evidence, estimator.rejected_hands)
            if trial.onset_s is None or observation.t <= trial.onset_s or not layout:
                layout = estimators[0].objects
        cut = getattr(reader, "cut", None)
        bounds = seen.bounds(trial) if trial.target != NO_REACH else None
        facts = describe_trial(trial, seen, bounds, layout)
    except IgripError as error:
        problem, bounds, facts = str(error), None, {}
    except Exception as error:  # one odd recording must not end the evaluation of all others
        problem, bounds, facts = f"cannot be judged: {error!r:.200}", None, {}
    problem = problem or _problem(trial, seen, bounds)
    inputs = estimators[0].inputs()["objects"]
    unknown = {f"{id}: {told['reason']}" for id, told in inputs.items() if not told["known"]}
    remarks = [*sorted(unknown), *_remarks(trial, seen, bounds), *([cut] if cut else [])]
    last = seen.times[-1] if seen.times else -math.inf
    rows = []
    for config, intentions, curve in zip(configs, said, curves, strict=True):
        row = base | facts | {"targets": config.targets, "problem": problem}
        row["remark"] = "; ".join(remarks) or None
        if not problem:
            row |= judge(trial, bounds, intentions, last)
            row |= judge_commitments(curve, trial.hand, trial.target, bounds)
        rows.append(row)
    return rows


def _problem(trial: Trial, seen: Seen, bounds: tuple[float, float] | None) -> str | None:
    """Say why a trial cannot be judged, in words."""
    if trial.performed == "no":
        return "was not performed"
    if trial.target is None:
        return "its target is not known"
    if not seen.times:
        return "the recording is empty"
    if trial.target == NO_REACH:
        return None
    if trial.hand is None:
        return "its hand is not known"
    return None if bounds is not None else "its movement has no onset and end"


def _remarks(trial: Trial, seen: Seen, bounds: tuple[float, float] | None) -> list[str]:
    """Say what is odd about a trial that counts all the same."""
    if trial.target in (None, NO_REACH):
        return []
    told = []
    if (trial.onset_s is None) != (trial.end_s is None):
        told.append("its onset or its end is missing, so both are those of the trace")
    if trial.camera_side not in (None, "left", "right"):
        told.append(f"camera_side {trial.camera_side!r} is neither left nor right")
    if bounds is not None and (cut := coverage(seen, bounds)):
        told.append(cut)
    if not any(seen.hand):
        told.append(f"hand {trial.hand!r} was never seen")
    return told + (
        [] if trial.target in seen.objects else [f"target {trial.target!r} never appears"]
    )


@dataclass(frozen=True)
class _Job:
    folder: Path
    number: int  # of the trial's row
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
    dataset, catalog = _datasets[job.folder], _catalogs[job.objects]
    stamp = {"row": job.number, "stamp": _stamp(dataset, job.trial)}
    return [stamp | row for row in evaluate_trial(dataset, job.trial, catalog, job.configs)]


def _stamp(dataset: Dataset, trial: Trial) -> str | None:
    """Return what changes when a recording does; None where there is none."""
    try:
        told = dataset.recording(trial).stat()
    except (IgripError, OSError):
        return None
    return f"{told.st_size}-{told.st_mtime_ns}"


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
        for name in ("trials.tsv", "dataset.json"):
            digest.update((self._dataset.path / name).read_bytes())
        for config in self._configs:
            digest.update(config.model_dump_json().encode())
        digest.update("\n".join(self._objects).encode())
        for path in sorted(Path(__file__).parents[2].rglob("*.py")):
            digest.update(path.read_bytes())  # another code, another answer
        return digest.hexdigest()[:16]

    def run(self, trials: Sequence[Trial], jobs: int) -> Iterator[int]:
        """Evaluate what is not done yet; yield how many trials are done."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        done = self._resume()
        number = {id(trial): k for k, trial in enumerate(self._dataset.trials)}
        chosen = [(number[id(trial)], trial) for trial in trials]
        left = [(k, trial) for k, trial in chosen if k not in done]
        finished = len(chosen) - len(left)
        yield finished
        work = [_Job(self._dataset.path, k, t, self._configs, self._objects) for k, t in left]
        rows = [row for k, _ in chosen for row in done.get(k, [])]
        try:
            with self._path.open("ab") as file:
                for new in in_processes(_run_job, work, min(jobs, max(1, len(work) // 10))):
                    for row in new:
                        file.write(json.dumps(row, allow_nan=False).encode() + b"\n")
                    file.flush()
                    rows += new
                    finished += 1
                    yield finished
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error
        order = {config.targets: c for c, config in enumerate(self._configs)}
        # the same rows in the same order, whatever was interrupted
        self.rows = sorted(rows, key=lambda row: (row["row"], order[row["targets"]]))

    def _resume(self) -> dict[int, list[Row]]:
        """Return the rows of an earlier run of the same evaluation, as far as they hold."""
        header = json.dumps({"evaluation": self._key}).encode() + b"\n"
        lines = self._path.read_bytes().split(b"\n") if self._path.exists() else []
        if not lines or lines[0] + b"\n" != header:
            self._path.write_bytes(header)
            return {}
        found: dict[int, list[Row]] = {}
        for line in lines[1:-1]:  # the last ends in the middle, or is empty
            try:
                row = json.loads(line)
            except ValueError:
                break
            found.setdefault(row["row"], []).append(row)
        trials = self._dataset.trials
        good = {
            k: rows for k, rows in found.items()
            if len(rows) == len(self._configs)
            and all(row["stamp"] == _stamp(self._dataset, trials[k]) for row in rows)
        }  # fmt: skip
        kept = b"".join(json.dumps(r).encode() + b"\n" for rows in good.values() for r in rows)
        self._path.write_bytes(header + kept)
        return good
