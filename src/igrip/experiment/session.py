"""One participant's session: trials are started, stopped, repeated and marked, and never lost.

The journal is the truth. An attempt counts from its ``trial_recorded`` on, which is written when
the files of all cameras are in their final place. Whatever ends the program before that, the
attempt is interrupted, its files are kept apart, and the trial comes again.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from igrip.errors import IgripError
from igrip.experiment.folder import StudyFolder
from igrip.experiment.journal import Journal
from igrip.experiment.plan import Plan, PlannedTrial
from igrip.experiment.progress import Attempt, AttemptState, SessionProgress, recording_name
from igrip.experiment.recorders import ENDING, TrialRecorder
from igrip.experiment.study import StudyError
from igrip.io.whole_files import sync_folder

TRANSITIONS = (
    "before_start", "started", "recording", "files_closed", "one_file_moved", "files_moved",
    "recorded", "table_written", "marked",
)  # fmt: skip
"""Moments of a session, in order, at which tests end the program."""


def _pass(transition: str) -> None:
    pass


class Session:
    """The trials of one participant.

    Parameters
    ----------
    folder : StudyFolder
        Of the study, locked by the caller.
    plan : Plan
        Of the participant.
    recorder : TrialRecorder
        Records with all cameras.
    passed : function
        Called with the name of each of the ``TRANSITIONS``.
    announce : function
        Called with each event once it is in the journal.

    Raises
    ------
    StudyError
        If the journal is damaged.
    """

    def __init__(
        self, folder: StudyFolder, plan: Plan, recorder: TrialRecorder,
        passed: Callable[[str], None] = _pass,
        announce: Callable[[Mapping[str, Any]], object] = lambda event: None,
    ) -> None:  # fmt: skip
        self.folder, self.plan, self._recorder, self._passed = folder, plan, recorder, passed
        self._announce = announce
        self._journal = Journal(folder.journal(plan.participant))
        self.progress = SessionProgress(plan, self._journal.events)
        self.remarks: list[str] = []
        if self._journal.torn:
            self.remarks.append(f"a crash tore {self._journal.torn} bytes off the journal")
        self._settle_interrupted()
        self._add("session_started")
        self.folder.write_table()

    @property
    def is_recording(self) -> bool:
        """Whether a trial is going on."""
        last = self.progress.last
        return last is not None and last.state is AttemptState.RECORDING

    @property
    def next_trial(self) -> PlannedTrial | None:
        """The trial that is going on or comes next; None: all are done."""
        return self.progress.next_trial

    def start(self) -> Attempt:
        """Begin the next trial.

        Raises
        ------
        StudyError
            If a trial is going on, or all are done.
        IgripError
            If a camera or the disk fails; the trial then has not begun.
        """
        trial = self.next_trial
        if self.is_recording:
            raise StudyError("a trial is going on: stop it first")
        if trial is None:
            raise StudyError("all trials are done")
        self._passed("before_start")
        self._add("trial_started", trial=trial.number, levels=dict(trial.levels))
        attempt = self._last()
        self._passed("started")
        files = {camera: self._partial(attempt, camera) for camera in self.folder.study.cameras}
        try:
            next(iter(files.values())).parent.mkdir(parents=True, exist_ok=True)
            self._recorder.start(trial, attempt.attempt, files)
        except (IgripError, OSError) as error:
            self._interrupt(str(error))
            raise
        self._recorder.mark(
            "trial", participant=self.plan.participant, trial=trial.number,
            attempt=attempt.attempt, levels=dict(trial.levels), layout=dict(trial.layout),
        )  # fmt: skip
        self._passed("recording")
        return attempt

    def stop(self) -> Attempt:
        """End the trial that is going on; it counts when this returns.

        Raises
        ------
        StudyError
            If none is going on.
        IgripError
            If a camera was lost or the disk is full: the attempt is interrupted, and the trial
            comes again.
        """
        if not self.is_recording:
            raise StudyError("no trial is going on")
        attempt = self._last()
        try:
            self._recorder.stop()
        except (IgripError, OSError) as error:
            self._interrupt(str(error))
            raise
        self._passed("files_closed")
        for k, camera in enumerate(self.folder.study.cameras):
            os.replace(self._partial(attempt, camera), self._final(attempt, camera))
            if k == 0:
                self._passed("one_file_moved")
        sync_folder(self.folder.recordings)
        self._passed("files_moved")
        self._add("trial_recorded")
        self._passed("recorded")
        self.folder.write_table()
        self._passed("table_written")
        return self._last()

    def failure(self) -> str | None:
        """Return what went wrong with the cameras since the start; None: nothing."""
        return self._recorder.failure()

    def abandon(self, why: str) -> None:
        """End the trial that is going on without counting it; it comes again."""
        if self.is_recording:
            try:
                self._recorder.stop()
            except (IgripError, OSError) as error:
                why = f"{why}; {error}"
            self._interrupt(why)

    def repeat(self) -> None:
        """Let the newest trial be done again; the old recording is kept, marked as repeated."""
        self._mark(AttemptState.REPEATED)

    def mark_wrong(self) -> None:
        """Note that the newest trial was not done as told; it is not done again."""
        self._mark(AttemptState.WRONG)

    def comment(self, text: str) -> None:
        """Note something about the newest trial.

        Raises
        ------
        StudyError
            If there was none yet.
        """
        if self.progress.last is None:
            raise StudyError("there is no trial yet to comment on")
        self._add("commented", text=" ".join(text.split())[:500])
        self.folder.write_table()

    def end_break(self) -> None:
        """Note that the break before the next trial is over."""
        following = self.next_trial
        if following is not None:
            self._add("break_ended", after=following.number - 1)

    def close(self) -> None:
        """End the session; a trial that is going on is interrupted and comes again."""
        self.abandon("the session was ended")
        self._add("session_ended")
        self._journal.close()

    def _mark(self, state: AttemptState) -> None:
        last = self.progress.last
        if self.is_recording:
            raise StudyError("a trial is going on: stop it first")
        if last is None or last.state is AttemptState.INTERRUPTED:
            raise StudyError("there is no recorded trial to mark")
        self._add("trial_marked", trial=last.trial, **{"as": state.value})
        self._passed("marked")
        self.folder.write_table()

    def _settle_interrupted(self) -> None:
        """Decide on an attempt that was going on when the program ended."""
        if not self.is_recording:
            return
        attempt = self._last()
        cameras = self.folder.study.cameras
        if all(self._final(attempt, camera).exists() for camera in cameras):
            # every file was closed and moved; only the journal did not get that far
            self._add("trial_recorded", recovered=True)
            self.remarks.append(f"trial {attempt.trial} was recorded as a whole before the end")
            return
        self._interrupt("the program ended")
        self.remarks.append(f"trial {attempt.trial} was interrupted and comes again")

    def _interrupt(self, why: str) -> None:
        """Keep the files of an attempt that does not count apart, and note it."""
        attempt = self._last()
        aside = self.folder.interrupted
        aside.mkdir(exist_ok=True)
        for camera in self.folder.study.cameras:
            for file in (self._partial(attempt, camera), self._final(attempt, camera)):
                if file.exists():
                    os.replace(file, aside / self._final(attempt, camera).name)
        self._add("trial_interrupted", trial=attempt.trial, why=why)

    def _last(self) -> Attempt:
        last = self.progress.last
        assert last is not None
        return last

    def _partial(self, attempt: Attempt, camera: str) -> Path:
        return self.folder.partial / self._final(attempt, camera).name

    def _final(self, attempt: Attempt, camera: str) -> Path:
        name = recording_name(self.plan.participant, attempt, camera)
        return self.folder.recordings / f"{name}.{ENDING}"

    def _add(self, event: str, **fields: Any) -> None:
        self._journal.add(event, **fields)
        self.progress.add(self._journal.events[-1])
        self._announce(self._journal.events[-1])

    def status(self) -> Mapping[str, Any]:
        """Return where the session stands, for the screens."""
        trial, last = self.next_trial, self.progress.last
        return {
            "participant": self.plan.participant, "done": len(self.progress.done),
            "of": len(self.plan.trials), "recording": self.is_recording,
            "break_due": self.progress.break_due(self.folder.study.breaks.every),
            "trial": None if trial is None else {
                "number": trial.number, "levels": dict(trial.levels), "layout": dict(trial.layout),
            },
            "last": None if last is None else {
                "trial": last.trial, "attempt": last.attempt, "state": last.state.value,
                "comment": last.comment,
            },
        }  # fmt: skip
