"""The folder of a study, which is a dataset: igrip evaluate and igrip check run on it."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import date
from pathlib import Path
from typing import Any

from igrip.errors import ObjectsError, UnknownModelError
from igrip.experiment.corrections import Corrections
from igrip.experiment.journal import Journal, read_events
from igrip.experiment.plan import Plan, draw_plan, read_plan, save_plan
from igrip.experiment.progress import AttemptState, SessionProgress, recording_name
from igrip.experiment.study import FILE, KNOWN, Study, StudyError, read_study, template_text
from igrip.io.datasets.dataset import FORMAT
from igrip.io.datasets.trial import COLUMNS
from igrip.io.whole_files import write_whole
from igrip.objects.catalog import Catalog, load_objects
from igrip.version import __version__

PSEUDONYM = re.compile(r"[A-Z]{1,3}[0-9]{1,4}")


def new_study(path: Path, template: str) -> None:
    """Write a study to begin with into a new folder.

    Raises
    ------
    StudyError
        If the folder holds something already.
    """
    text = template_text(template)
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise StudyError(f"{path}: exists already; name a new folder")
    path.mkdir(parents=True, exist_ok=True)
    write_whole(path / FILE, text)


class StudyFolder:
    """A study on disk.

    ::

        study.toml                    what the lab wants to measure
        dataset.json, trials.tsv, participants.tsv, recordings/
        sessions/P01/plan.tsv, journal.jsonl, review.jsonl
        interrupted/                  recordings of attempts that do not count

    Parameters
    ----------
    path : Path
        The folder.

    Raises
    ------
    StudyError
        If it holds no study that can be run.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.study: Study = read_study(path)
        self.recordings = path / "recordings"
        self.partial = path / "interrupted" / "unfinished"
        self.interrupted = path / "interrupted"

    def journal(self, participant: str) -> Path:
        """Return the journal of a participant."""
        return self.path / "sessions" / participant / "journal.jsonl"

    def review(self, participant: str) -> Path:
        """Return the file of what was corrected in a participant's trials."""
        return self.path / "sessions" / participant / "review.jsonl"

    def _plan(self, participant: str) -> Path:
        return self.path / "sessions" / participant / "plan.tsv"

    def participants(self) -> list[str]:
        """Return the participants who have a session."""
        return sorted(path.parent.name for path in self.path.glob("sessions/*/plan.tsv"))

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other experimenters out, in whatever process, until the block ends.

        Raises
        ------
        StudyError
            If another one runs this study.
        """
        import fcntl

        with (self.path / ".lock").open("a+") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise StudyError(
                    f"{self.path}: another igrip experiment is running this study; end it first"
                ) from None
            yield  # the lock ends with the process, however it ends

    def catalog(self) -> Catalog:
        """Return the catalog with the study's models, each of them built.

        Raises
        ------
        StudyError
            If a model or a folder of meshes is missing; the message names the key.
        """
        key = "models"
        try:
            named = [(self.path / one, one) for one in self.study.models]
            found = load_objects(*(inside if inside.is_dir() else one for inside, one in named))
            for id, one in self.study.objects.items():
                key = f"objects.{id}.model"
                found[one.model]
        except (ObjectsError, UnknownModelError) as error:
            raise StudyError(f"{self.path / FILE}: {key}: {error}") from error
        return found

    def check(self, participant: str, consent: str | None) -> Plan | None:
        """Return the saved plan of a participant; None: it is a new one who may be enrolled.

        Parameters and errors are those of :meth:`enrol`.
        """
        if not PSEUDONYM.fullmatch(participant):
            raise StudyError(
                f"--participant {participant!r:.40}: give a pseudonym such as P01; names of people "
                "do not belong in a dataset"
            )
        path = self._plan(participant)
        if path.exists():
            plan = read_plan(path)
            self._refuse_other_factors(plan, path)
            return plan
        if consent is None:
            raise StudyError(
                f"{participant} is new: give the date of consent, --consent {date.today()}"
            )
        try:
            given = date.fromisoformat(consent)
        except ValueError:
            raise StudyError(
                f"--consent {consent!r:.40}: is no date such as {date.today()}"
            ) from None
        if given > date.today():
            raise StudyError(f"--consent {consent}: lies in the future")
        return None

    def enrol(self, participant: str, consent: str | None) -> Plan:
        """Return the plan of a participant: the saved one, or a new one.

        Parameters
        ----------
        participant : str
            A pseudonym such as ``P01``, never a name.
        consent : str, optional
            Date on which the participant consented, ``2026-01-31``; needed the first time.

        Raises
        ------
        StudyError
            If it looks like a name, there is no consent, or the study's factors changed.
        """
        saved = self.check(participant, consent)
        if saved is not None:
            return saved
        path = self._plan(participant)
        plan = draw_plan(self.study, participant)
        path.parent.mkdir(parents=True, exist_ok=True)
        self.recordings.mkdir(exist_ok=True)
        journal = Journal(path.with_name("journal.jsonl"))
        journal.add("enrolled", participant=participant, consent=consent, igrip=__version__)
        journal.close()
        self._write_description()
        save_plan(plan, path)  # the last step: only now the participant is enrolled
        self.write_table()
        return plan

    def _refuse_other_factors(self, plan: Plan, path: Path) -> None:
        """Raise an error where the plan was drawn for another study than there is now."""
        levels = {
            factor: {trial.levels.get(factor) for trial in plan.trials}
            for factor in plan.trials[0].levels
        }
        places = {place for trial in plan.trials for place in trial.layout.values()}
        kinds = {
            "factors or levels": levels == {
                factor: set(names) for factor, names in self.study.factors.items()
            },
            "objects": set(plan.trials[0].layout) == set(self.study.objects),
            "places": places <= set(self.study.layouts.places),
        }  # fmt: skip
        for kind, same in kinds.items():
            if not same:
                raise StudyError(
                    f"{path}: was drawn for other {kind} than {FILE} has now; restore {FILE}, or "
                    "make a new study for the changed one"
                )

    def progress(self, participant: str) -> SessionProgress:
        """Return where a participant stands, without changing anything."""
        plan = read_plan(self._plan(participant))
        events = read_events(self.journal(participant))
        return SessionProgress(plan, events)

    def write_table(self) -> None:
        """Write the tables of the dataset from the journals."""
        more = [factor for factor in self.study.factors if factor not in KNOWN]
        columns = [*COLUMNS, *more, "attempt", "layout", "reviewed", "comment"]
        rows: list[Mapping[str, Any]] = []
        for participant in self.participants():
            rows += self._rows(participant)
        write_whole(self.path / "trials.tsv", _table(columns, rows))
        people = [{"participant": name} for name in self.participants()]
        write_whole(self.path / "participants.tsv", _table(["participant"], people))

    def _rows(self, participant: str) -> Iterator[Mapping[str, Any]]:
        plan = read_plan(self._plan(participant))
        progress = self.progress(participant)
        corrections = Corrections(read_events(self.review(participant)))
        before: dict[int, str] = {}  # trial to its first recording by the first camera
        for attempt in progress.attempts:
            if attempt.state in (AttemptState.RECORDING, AttemptState.INTERRUPTED):
                continue
            trial = plan.trials[attempt.trial - 1]
            judged = corrections.performed(attempt.trial, attempt.attempt)
            performed = attempt.state is AttemptState.RECORDED if judged is None else judged
            for camera in self.study.cameras:
                name = recording_name(participant, attempt, camera)
                bounds = corrections.bounds(name)
                yield {
                    "recording": name, "participant": participant, "trial": attempt.trial,
                    "camera": camera, "camera_side": camera if camera in ("left", "right") else "",
                    **trial.levels, "performed": "yes" if performed else "no",
                    "onset_s": bounds[0] if bounds else "", "end_s": bounds[1] if bounds else "",
                    "repeat_of": before.get(attempt.trial, ""), "attempt": attempt.attempt,
                    "layout": " ".join(f"{id}:{place}" for id, place in trial.layout.items()),
                    "reviewed": "yes" if bounds or judged is not None else "",
                    "comment": attempt.comment.replace("\t", " "),
                }  # fmt: skip
            first = recording_name(participant, attempt, self.study.cameras[0])
            before.setdefault(attempt.trial, first)

    def _write_description(self) -> None:
        """Write dataset.json."""
        description = {
            "format": FORMAT, "name": self.study.name, "license": self.study.license,
            "source": f"igrip experiment, igrip {__version__}", "objects": list(self.study.models),
        }  # fmt: skip
        text = json.dumps(description, indent=2, ensure_ascii=False)
        write_whole(self.path / "dataset.json", text + "\n")


def _table(columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(
        text, columns, extrasaction="ignore", restval="", delimiter="\t", lineterminator="\n"
    )
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
