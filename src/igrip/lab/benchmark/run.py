"""Entries over the trials of a set, by workers; what is done is kept when it is cut short."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from igrip.errors import IgripError, RecordingError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.lab.benchmark.entries import Entry, EntryError
from igrip.lab.benchmark.score import Row, score_recording
from igrip.lab.benchmark.sets import BenchmarkSet
from igrip.lab.evaluation.fingerprint import recording_stamp
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from igrip.lab.evaluation.runner import shift_trial
from igrip.lab.parallel import Workers
from igrip.objects.catalog import Catalog


def run_entry(
    entry: Entry, judged: BenchmarkSet, catalog: Catalog, out: Path, workers: Workers
) -> Iterator[Row]:
    """Yield the scores of an entry in each trial of a set, in order.

    ``rows-SET-ENTRY.jsonl`` in the folder ``out`` holds what is done; the trials whose recordings
    are unchanged are not run again. Remove it after a change of the entry itself.

    Raises
    ------
    EntryError
        If the entry fails: one that cannot answer every recording is not in the table.
    """
    path = out / f"rows-{judged.name}-{entry.name}-{zlib.crc32(entry.source.encode()):08x}.jsonl"
    stamps = {t.recording: recording_stamp(judged.dataset, t) for t in judged.trials}
    done = _done(path, stamps)
    left = [trial for trial in judged.trials if trial.recording not in done]
    found = workers.map(partial(_answer, entry, judged.dataset, catalog), left)
    with path.open("w", encoding="utf-8") as file:
        for trial in judged.trials:
            row = done.get(trial.recording) or next(found)
            row |= {"set": judged.name, "entry": entry.name, "stamp": stamps[trial.recording]}
            file.write(json.dumps(row, allow_nan=False) + "\n")
            file.flush()
            yield row


def _done(path: Path, stamps: dict[str, str | None]) -> dict[str, Row]:
    """Return the rows of an earlier run whose recordings are as they were."""
    rows: dict[str, Row] = {}
    try:
        for line in path.read_text(encoding="utf-8").splitlines():
            row = json.loads(line)
            if stamps.get(row["recording"]) == row["stamp"]:
                rows[row["recording"]] = row
    except (OSError, ValueError, KeyError):
        pass  # there is none, or its last line was cut off
    return rows


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
    return score_recording(recorded, entry.run(observations, catalog))


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
