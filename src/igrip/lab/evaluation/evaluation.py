"""An evaluation of any number of estimators over a dataset: parallel, and resumed if cut short."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from igrip.config import Config
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.lab.evaluation.fingerprint import fingerprint
from igrip.lab.evaluation.kept_rows import KeptRows
from igrip.lab.evaluation.runner import run_trials
from igrip.lab.evaluation.trial_rows import Row, score_run
from igrip.lab.parallel import Workers, count_jobs
from igrip.objects.catalog import load_objects


class Evaluation:
    """Rows of an evaluation, kept in a file as they come.

    ``rows.jsonl`` in the folder ``out`` holds what is done; ``objects`` are sources in place of the
    dataset's own.
    """

    def __init__(
        self, dataset: Dataset, configs: Sequence[Config], out: Path, objects: Sequence[str] = ()
    ) -> None:
        sources = tuple(objects) or dataset.objects
        self._dataset, self._configs = dataset, tuple(configs)
        self.catalog = load_objects(*sources)
        key = fingerprint(dataset, configs, sources)
        header = json.dumps({"evaluation": key}).encode() + b"\n"
        self._kept = KeptRows(out / "rows.jsonl", header)
        self._chosen: list[int] = []

    @property
    def rows(self) -> Iterator[Row]:
        """The rows of the trials that were asked for last, in the order of the dataset."""
        return self._kept.read(sorted(self._chosen))

    def run(self, trials: Sequence[Trial], workers: Workers) -> Iterator[int]:
        """Evaluate what is not done yet; yield how many trials are done.

        ``workers`` with more than one job are as many as the trials that are left keep busy.
        """
        self._kept.resume(self._is_good)
        number = {id(trial): k for k, trial in enumerate(self._dataset.trials)}
        self._chosen = [number[id(trial)] for trial in trials]
        left = [k for k in self._chosen if k not in self._kept]
        # taken before a recording is read: one that changes meanwhile is read again next time
        stamps = {k: self._dataset.stamp(self._dataset.trials[k]) for k in left}
        finished = len(self._chosen) - len(left)
        yield finished
        results = run_trials(
            self._dataset, self.catalog, self._configs, score_run,
            [self._dataset.trials[k] for k in left],
            replace(workers, jobs=count_jobs(workers.jobs, len(left))),
        )  # fmt: skip
        for k, rows in zip(left, results, strict=True):
            self._kept.add(k, [{"row": k, "stamp": stamps[k]} | row for row in rows])
            finished += 1
            yield finished

    def _is_good(self, k: int, rows: Sequence[Row]) -> bool:
        """Return whether rows of an earlier run are complete and of the recording as it is."""
        if not 0 <= k < len(self._dataset.trials) or len(rows) != len(self._configs):
            return False
        stamp = self._dataset.stamp(self._dataset.trials[k])
        return all(row.get("stamp") == stamp for row in rows)
