"""Writing datasets: complete, or not there."""

from __future__ import annotations

import csv
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, TextIO

from igrip.errors import DatasetError
from igrip.io.datasets.dataset import FORMAT, Dataset, check_name
from igrip.io.datasets.trial import COLUMNS, Trial
from igrip.io.recordings.jsonl import JsonlWriter
from igrip.observation import Observation

ADDED = "added.jsonl"  # what an unfinished dataset is, and a line for each trial


class DatasetWriter:
    """Write a dataset: each recording when it is added, the tables at the end.

    The files go into a hidden folder beside the final one, which :meth:`close` renames, so that a
    dataset is complete or does not exist. As a context manager, it removes an unfinished one,
    unless that is to be kept: then another writer of the same dataset goes on with it.

    Parameters
    ----------
    path : str or Path
        A folder that does not exist yet, or is empty.
    name, license, source : str
        For ``dataset.json``.
    resume : str, optional
        Keeps an unfinished dataset, which a writer with the same text goes on with.
    **description
        Further entries of it, for example ``objects``.

    Attributes
    ----------
    trials : list of Trial
        What was added, in order; also by an earlier writer whose dataset was kept.

    Raises
    ------
    DatasetError
        If the folder is not empty, or another process writes it.
    """

    def __init__(
        self, path: str | Path, name: str, license: str, source: str,
        resume: str | None = None, **description: Any,
    ) -> None:  # fmt: skip
        self._final = Path(path)
        if self._final.exists() and (not self._final.is_dir() or any(self._final.iterdir())):
            raise DatasetError(f"{self._final}: exists already; name a new folder")
        self._final.parent.mkdir(parents=True, exist_ok=True)
        self._description = {
            "format": FORMAT, "name": name, "license": license, "source": source, **description,
        }  # fmt: skip
        self.trials: list[Trial] = []
        self._log: TextIO | None = None
        if resume is not None:
            self.path = self._final.with_name(f".{self._final.name}-unfinished")
            self._go_on(resume)
        else:
            self.path = Path(
                tempfile.mkdtemp(dir=self._final.parent, prefix=f".{self._final.name}-")
            )
        self._names = {trial.recording for trial in self.trials}
        (self.path / "recordings").mkdir(exist_ok=True)

    def _go_on(self, resume: str) -> None:
        """Take over what an earlier writer of the same dataset has added."""
        log = self.path / ADDED
        self.path.mkdir(exist_ok=True)
        self._log = log.open("a+", encoding="utf-8")
        if not _locked(self._log):
            self._log.close()
            raise DatasetError(f"{self._final}: another process writes it")
        self._log.seek(0)
        begun, *lines = self._log.read().split("\n")
        of = {"resume": resume, **self._description}
        if begun == json.dumps(of):
            for line in lines:
                try:
                    self.trials.append(Trial(**json.loads(line)))
                except (ValueError, TypeError):
                    break  # it was cut short
        self._log.seek(0)
        self._log.truncate()
        self._note(of, *map(asdict, self.trials))

    def _note(self, *rows: Mapping[str, Any]) -> None:
        if self._log is not None:
            self._log.writelines(json.dumps(row) + "\n" for row in rows)
            self._log.flush()

    def add(self, trial: Trial, observations: Iterable[Observation]) -> None:
        """Write one recording and keep its row for the table.

        Raises
        ------
        DatasetError
            If the recording's name is no plain file name, or not new.
        """
        check_name(trial.recording)
        if trial.recording in self._names:
            raise DatasetError(f"two recordings are named {trial.recording!r}")
        path = self.path / "recordings" / f"{trial.recording}.jsonl"
        try:
            with JsonlWriter(path) as file:
                for observation in observations:
                    file.write(observation)
        except BaseException:
            path.unlink(missing_ok=True)  # the trial is not added
            raise
        self.trials.append(trial)
        self._names.add(trial.recording)
        self._note(asdict(trial))

    def close(self, participants: Mapping[str, Mapping[str, str]] | None = None) -> Dataset:
        """Write the tables and return the dataset.

        Parameters
        ----------
        participants : mapping, optional
            Further columns of ``participants.tsv``, by participant.
        """
        text = json.dumps(self._description, indent=2, ensure_ascii=False)
        (self.path / "dataset.json").write_text(text + "\n", encoding="utf-8")
        more = sorted({name for trial in self.trials for name in trial.extra})
        rows = [asdict(trial) | dict(trial.extra) for trial in self.trials]
        _write_table(self.path / "trials.tsv", [*COLUMNS, *more], rows)
        known = dict(participants or {})
        names = list(dict.fromkeys(t.participant for t in self.trials if t.participant))
        columns = sorted({column for row in known.values() for column in row})
        people = [{"participant": name, **known.get(name, {})} for name in names]
        _write_table(self.path / "participants.tsv", ["participant", *columns], people)
        if self._log is not None:
            (self.path / ADDED).unlink()
            self._log.close()
        self.path.chmod(0o755)  # a temporary folder is private
        os.replace(self.path, self._final)
        self.path = self._final
        return Dataset(self.path, self._description, tuple(self.trials))

    def __enter__(self) -> DatasetWriter:
        return self

    def __exit__(self, *exception: object) -> None:
        if self.path != self._final and (self._log is None or not self.trials):  # not closed
            shutil.rmtree(self.path, ignore_errors=True)
        if self._log is not None:
            self._log.close()  # and with it the lock


def _locked(file: TextIO) -> bool:
    """Keep other processes from a file, as long as it is open; False: one has it."""
    try:
        import fcntl
    except ImportError:  # Windows has other locks, and there two writers are the user's own risk
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _write_table(path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(
            file, columns, extrasaction="ignore", delimiter="\t", lineterminator="\n"
        )
        writer.writeheader()
        writer.writerows(rows)
