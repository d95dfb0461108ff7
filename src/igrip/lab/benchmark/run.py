"""Entries over the trials of a set, by workers; what is done is kept when it is cut short."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from igrip.errors import IgripError, RecordingError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.lab.benchmark.answers import EntryError
from igrip.lab.benchmark.entries import Entry
from igrip.lab.benchmark.score import Row, score_recording
from igrip.lab.benchmark.sets import BenchmarkSet
from igrip.lab.evaluation.fingerprint import fingerprint
from igrip.lab.evaluation.kept_rows import KeptRows
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from igrip.lab.evaluation.runner import shift_trial
from igrip.lab.parallel import Workers
from igrip.objects.catalog import Catalog


def run_entry(
    entry: Entry, judged: BenchmarkSet, catalog: Catalog, out: Path, workers: Workers
) -> Iterator[Row]:
    """Yield the scores of an entry in each trial of a set, in order.

    ``rows-SET-ENTRY.jsonl`` in the folder ``out`` holds what is done; trials whose recordings are
    unchanged are not run again, unless the tables, meshes, igrip or the entry's own files changed.

    Raises
    ------
    EntryError
        If the entry fails: one that cannot answer every recording is not in the table.
    """
    dataset = judged.dataset
    key = f"{fingerprint(dataset, [], dataset.objects)}-{entry.digest()}"
    header = json.dumps({"benchmark": key}).encode() + b"\n"
    kept = KeptRows(out / f"rows-{judged.name}={entry.name}.jsonl", header)
    place = {id(trial): k for k, trial in enumerate(dataset.trials)}
    chosen = {place[id(trial)]: trial for trial in judged.trials}
    stamps = {k: dataset.stamp(trial) for k, trial in chosen.items()}

    def is_good(k: int, rows: Sequence[Row]) -> bool:
        if not 0 <= k < len(dataset.trials) or len(rows) != 1:
            return False
        stamp = stamps[k] if k in stamps else dataset.stamp(dataset.trials[k])
        return bool(rows[0].get("stamp") == stamp)

    kept.resume(is_good)
    left = [trial for k, trial in chosen.items() if k not in kept]
    found = workers.map(partial(_answer, entry, dataset, catalog), left)
    for k, stamp in stamps.items():
        if k not in kept:
            own = {"row": k, "set": judged.name, "entry": entry.name, "stamp": stamp}
            kept.add(k, [own | next(found)])
        yield from kept.read([k])


def _answer(entry: Entry, dataset: Dataset, catalog: Catalog, trial: Trial) -> Row:
    """Return the scores of an entry in one trial."""
    if trial.problem:
        return _excluded(trial, trial.problem)
    try:
        trial = dataset.with_hand(trial)
        reader = dataset.observations(trial)
        observations = list(reader)
    except RecordingError as error:
        return _excluded(trial, str(error))
    recorded = RecordedTrial(shift_trial(trial, getattr(reader, "shift", 0.0)))
    for observation in observations:
        recorded.add(observation)
    try:
        answers = entry.run(observations, catalog)
    except EntryError as error:
        raise EntryError(f"{error} in {trial.recording}") from error
    return score_recording(recorded, answers)


def _excluded(trial: Trial, problem: str) -> Row:
    return {
        "recording": trial.recording, "participant": trial.participant or "unknown",
        "target": trial.target, "reach": False, "problem": problem, "seconds": 0.0,
    }  # fmt: skip


def check_entries(entries: Sequence[Entry], judged: BenchmarkSet, catalog: Catalog) -> None:
    """Let each entry answer one recording, before anything slow begins.

    Raises
    ------
    EntryError
        If one fails.
    """
    for trial in judged.trials:
        try:
            observations = list(judged.dataset.observations(trial))[:10]
        except IgripError:
            continue
        for entry in entries:
            if entry.how != "targets":
                entry.run(observations, catalog)
        return
    raise EntryError(f"{judged.name}: has no recording that can be read")
