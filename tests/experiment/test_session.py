"""Sessions: every trial exactly once, whatever ends the program, at every named transition."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from igrip.errors import RecordingError
from igrip.experiment.folder import StudyFolder
from igrip.experiment.journal import read_events
from igrip.experiment.progress import AttemptState
from igrip.experiment.session import TRANSITIONS, Session
from igrip.experiment.study import StudyError
from igrip.experiment.unattended import run_unattended
from igrip.io.datasets.trial import read_trials
from small_study import FakeRecorder, small_study

TODAY = "2026-01-31"
KILLED = """
import os, signal, sys
from pathlib import Path
sys.path.insert(0, sys.argv[4])
from igrip.experiment.folder import StudyFolder
from igrip.experiment.session import Session
from small_study import FakeRecorder
left = [int(sys.argv[3])]
def passed(name):
    if name == sys.argv[2]:
        left[0] -= 1
        if not left[0]:
            os.kill(os.getpid(), signal.SIGKILL)
folder = StudyFolder(Path(sys.argv[1]))
with folder.locked():
    session = Session(folder, folder.enrol("P01", "2026-01-31"), FakeRecorder(), passed)
    repeated = False
    while session.next_trial is not None:
        session.start()
        session.stop()
        if session.progress.last.trial == 3 and session.progress.last.attempt == 1:
            session.repeat()
    session.close()
"""


def opened(folder, recorder=None):
    return Session(folder, folder.enrol("P01", TODAY), recorder or FakeRecorder())


def counted(folder):
    """Return the trials of the table that count, one row each, and check the files."""
    rows = read_trials(folder.path / "trials.tsv", lenient=False)
    files = {path.name for path in folder.recordings.iterdir()}
    assert files == {f"{row.recording}.mcap" for row in rows}
    return [(int(row.trial), row.camera) for row in rows if row.performed == "yes"]


@pytest.mark.parametrize("transition", TRANSITIONS)
def test_a_kill_at_any_transition_loses_and_repeats_nothing(tmp_path, transition):
    folder = small_study(tmp_path / "study")
    script = [sys.executable, "-c", KILLED, str(folder.path)]
    here = str(Path(__file__).parents[1])
    for count in (1, 2) if transition != "marked" else (1,):
        ended = subprocess.run([*script, transition, str(count), here], capture_output=True)
        assert ended.returncode == -9, ended.stderr.decode()
    ended = subprocess.run([*script, "never", "1", here], capture_output=True)
    assert ended.returncode == 0, ended.stderr.decode()
    assert counted(folder) == [(n, camera) for n in range(1, 9) for camera in ("left", "right")]
    events = read_events(folder.journal("P01"))
    repeats = sum(e["event"] == "trial_marked" for e in events)
    rows = read_trials(folder.path / "trials.tsv", lenient=False)
    assert len(rows) == 2 * (8 + repeats)
    # what was interrupted is kept apart, whole or not
    started = sum(e["event"] == "trial_started" for e in events)
    recorded = sum(e["event"] == "trial_recorded" for e in events)
    assert started - recorded == sum(e["event"] == "trial_interrupted" for e in events)


def test_a_repeated_trial_keeps_the_old_one(tmp_path):
    folder = small_study(tmp_path / "study")
    session = opened(folder)
    session.start()
    session.stop()
    session.comment("looked\taway")
    session.repeat()
    assert session.next_trial.number == 1
    session.start()
    session.stop()
    session.start()
    session.stop()
    session.mark_wrong()
    assert session.next_trial.number == 3
    session.close()
    rows = read_trials(folder.path / "trials.tsv", lenient=False)
    left = [row for row in rows if row.camera == "left"]
    assert [(r.recording, r.trial, r.performed, r.repeat_of) for r in left] == [
        ("P01_t001_left", "1", "no", None), ("P01_t001-2_left", "1", "yes", "P01_t001_left"),
        ("P01_t002_left", "2", "no", None),
    ]  # fmt: skip
    assert left[0].extra["comment"] == "looked away"


@pytest.mark.parametrize("when", ["start", "stop"])
def test_a_camera_that_fails_costs_the_attempt_alone(tmp_path, when):
    folder, recorder = small_study(tmp_path / "study"), FakeRecorder()
    session = opened(folder, recorder)
    recorder.fails = when
    if when == "stop":
        session.start()
    with pytest.raises(RecordingError, match="camera"):
        session.start() if when == "start" else session.stop()
    assert session.progress.last.state is AttemptState.INTERRUPTED
    recorder.fails = None
    assert session.next_trial.number == 1
    for _ in run_unattended(session):
        pass
    session.close()
    assert counted(folder) == [(n, camera) for n in range(1, 9) for camera in ("left", "right")]


def test_orders_out_of_turn_are_refused(tmp_path):
    session = opened(small_study(tmp_path / "study"))
    for act in (session.stop, session.repeat, session.mark_wrong, lambda: session.comment("x")):
        with pytest.raises(StudyError):
            act()
    session.start()
    for act in (session.start, session.repeat, session.mark_wrong):
        with pytest.raises(StudyError, match="going on"):
            act()
    session.stop()
    session.close()


def test_two_experimenters_at_once_are_refused(tmp_path):
    folder = small_study(tmp_path / "study")
    other = StudyFolder(folder.path).locked()
    with folder.locked(), pytest.raises(StudyError, match="another igrip"), other:
        pass
    with StudyFolder(folder.path).locked():
        pass


@pytest.mark.parametrize(("participant", "consent", "words"), [
    ("Anna", TODAY, "pseudonym"), ("P1/../x", TODAY, "pseudonym"), ("P01", None, "--consent"),
    ("P01", "yesterday", "no date"), ("P01", "2999-01-01", "future"),
])  # fmt: skip
def test_nobody_takes_part_without_pseudonym_and_consent(tmp_path, participant, consent, words):
    folder = small_study(tmp_path / "study")
    with pytest.raises(StudyError, match=words):
        folder.enrol(participant, consent)
    assert folder.participants() == []


def test_a_study_that_changed_does_not_go_on(tmp_path):
    folder = small_study(tmp_path / "study")
    folder.enrol("P01", TODAY)
    file = folder.path / "study.toml"
    file.write_text(file.read_text().replace('grip = ["palmar", "pinch"]', 'grip = ["pinch"]'))
    with pytest.raises(StudyError, match="other factors"):
        StudyFolder(folder.path).enrol("P01", None)


def test_a_break_comes_when_due_and_once(tmp_path):
    session = opened(small_study(tmp_path / "study"))
    for _ in range(4):
        assert not session.status()["break_due"]
        session.start()
        session.stop()
    assert session.status()["break_due"]
    session.end_break()
    assert not session.status()["break_due"]
    session.start()
    session.stop()
    session.repeat()
    assert not session.status()["break_due"]
    session.close()
