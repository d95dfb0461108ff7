"""An evaluation of any number of estimators over a dataset: parallel, and resumed if cut short."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from igrip.config import Config
from igrip.errors import RecordingError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.lab.evaluation.fingerprint import fingerprint, recording_stamp
from igrip.lab.evaluation.runner import run_trials
from igrip.lab.evaluation.trial_rows import Row, score_run
from igrip.lab.parallel import Workers, count_jobs
from igrip.objects.catalog import load_objects


class Evaluation:
    """Rows of an evaluation, kept in a file as they come.

    ``rows.jsonl`` in the folder ``out`` holds what is done; ``objects`` are sources in place of the
    dataset's own. Once all is done, ``rows`` are those of the trials that were asked for last.
    """

    def __init__(
        self, dataset: Dataset, configs: Sequence[Config], out: Path, objects: Sequence[str] = ()
    ) -> None:
        sources = tuple(objects) or dataset.objects
        self._dataset, self._configs = dataset, tuple(configs)
        self.catalog = load_objects(*sources)
        self._path = out / "rows.jsonl"
        key = fingerprint(dataset, configs, sources)
        self._header = json.dumps({"evaluation": key}).encode() + b"\n"
        self.rows: list[Row] = []

    def run(self, trials: Sequence[Trial], workers: Workers) -> Iterator[int]:
        """Evaluate what is not done yet; yield how many trials are done.

        ``workers`` with more than one job are as many as the trials that are left keep busy.
        """
        self._path.parent.mkdir(parents=True, exist_ok=True)
        done = self._resume()
        number = {id(trial): k for k, trial in enumerate(self._dataset.trials)}
        chosen = [number[id(trial)] for trial in trials]
        left = [k for k in chosen if k not in done]
        # taken before a recording is read: one that changes meanwhile is read again next time
        stamps = {k: recording_stamp(self._dataset, self._dataset.trials[k]) for k in left}
        finished = len(chosen) - len(left)
        yield finished
        results = run_trials(
            self._dataset, self.catalog, self._configs, score_run,
            [self._dataset.trials[k] for k in left],
            replace(workers, jobs=count_jobs(workers.jobs, len(left))),
        )  # fmt: skip
        try:
            with self._path.open("ab") as file:
                for k, rows in zip(left, results, strict=True):
                    done[k] = [{"row": k, "stamp": stamps[k]} | row for row in rows]
                    file.writelines(map(_line, done[k]))
                    file.flush()
                    finished += 1
                    yield finished
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error
        # the same rows in the same order, whatever was interrupted
        self.rows = [row for k in sorted(chosen) for row in done[k]]

    def _resume(self) -> dict[int, list[Row]]:
        """Return the rows of an earlier run of the same evaluation, as far as they hold."""
        lines = self._path.read_bytes().splitlines(keepends=True) if self._path.exists() else []
        if not lines or lines[0] != self._header:
            self._path.write_bytes(self._header)
            return {}
        found: dict[int, list[Row]] = {}
        for line in lines[1:]:
            try:
                row = json.loads(line)
            except ValueError:
                break  # it was cut short
            found.setdefault(row["row"], []).append(row)
        trials = self._dataset.trials
        good = {
            k: rows for k, rows in found.items()
            if len(rows) == len(self._configs)
            and all(row["stamp"] == recording_stamp(self._dataset, trials[k]) for row in rows)
        }  # fmt: skip
        kept = b"".join(_line(row) for rows in good.values() for row in rows)
        self._path.write_bytes(self._header + kept)
        return good


def _line(row: Row) -> bytes:
    return json.dumps(row, allow_nan=False).encode() + b"\n"
