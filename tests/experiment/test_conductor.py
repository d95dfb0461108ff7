"""Orders and what the screens show, on a clock that the test sets."""

from __future__ import annotations

import pytest

from igrip.experiment.conductor import MIN_FREE, THANKS, Conductor
from igrip.experiment.progress import AttemptState
from igrip.experiment.session import Session
from igrip.experiment.study import read_instructions
from runtime_fakes import Clock
from small_study import FakeRecorder, small_study


class Room:
    """A session with its conductor, a fake recorder and a clock."""

    def __init__(self, path, **changes):
        folder = small_study(path, **changes)
        self.recorder, self.clock, self.free = FakeRecorder(), Clock(100.0), 50 << 30
        self.session = Session(folder, folder.enrol("P01", "2026-01-31"), self.recorder)
        self.conductor = Conductor(
            self.session, read_instructions(folder.path, folder.study.language),
            self.recorder.seen, self.clock, lambda: self.free,
        )  # fmt: skip

    def order(self, name, text="", after=2.0 * THANKS):
        self.clock.t += after
        assert self.conductor.order(name, text)
        self.conductor.step()
        return self.conductor.experimenter_screen()


@pytest.fixture
def room(tmp_path):
    one = Room(tmp_path / "study")
    yield one
    one.session.close()


def test_a_whole_session(room):
    seen = []
    for _ in range(8):
        if room.conductor.participant_screen()["phase"] == "rest":
            room.order("end_break")
        shown = room.conductor.participant_screen()
        trial = room.session.next_trial
        assert (shown["phase"], shown["trial"]["target"]) == ("ready", trial.levels["target"])
        assert shown["trial"]["lines"][0] == "Right hand"
        seen.append(trial.number)
        assert room.order("start")["phase"] == "go"
        assert room.order("stop")["phase"] == "stop"
        room.clock.t += 2.0 * THANKS
    assert seen == list(range(1, 9))
    screen = room.conductor.experimenter_screen()
    assert (screen["phase"], screen["done"], screen["seconds_left"]) == ("finished", 8, 0.0)
    assert "all trials are done" in room.order("start")["problem"]


def test_no_trial_starts_while_something_is_not_seen(room):
    room.recorder.lost = {"soup": False}
    screen = room.order("start")
    assert (screen["recording"], screen["problem"]) == (False, "not seen: soup")
    room.recorder.lost = {}
    assert room.order("start")["recording"]


def test_no_trial_starts_on_a_disk_that_is_nearly_full(room):
    room.free = MIN_FREE - 1
    screen = room.order("start")
    assert not screen["recording"]
    assert "MiB are left" in screen["problem"]


def test_a_trial_that_nobody_stops_stops_by_itself(room):
    room.order("start")
    room.clock.t += 9.9
    room.conductor.step()
    assert room.session.is_recording
    room.clock.t += 0.2
    room.conductor.step()
    assert room.session.progress.last.state is AttemptState.RECORDED
    assert "after 10 s" in room.conductor.problem


def test_a_camera_that_vanishes_costs_the_attempt_alone(room):
    room.order("start")
    room.recorder.failed = "camera left: unplugged"
    room.conductor.step()
    screen = room.conductor.experimenter_screen()
    assert screen["last"]["state"] == "interrupted"
    assert "comes again" in screen["problem"]
    assert screen["trial"]["number"] == 1


def test_breaks_are_counted_down_and_ended_by_the_experimenter(room):
    for _ in range(4):
        room.order("start")
        room.order("stop")
    room.clock.t += THANKS
    shown = room.conductor.participant_screen()
    assert shown["phase"] == "rest"
    assert shown["rest_left"] == pytest.approx(60.0 - THANKS)
    assert "rests" in room.order("start")["problem"]
    assert room.order("end_break")["phase"] == "ready"


def test_marks_and_comments(room):
    room.order("start")
    room.order("stop")
    assert room.order("comment", "sneezed")["last"]["comment"] == "sneezed"
    assert room.order("repeat")["trial"]["number"] == 1
    assert room.order("repeat")["last"]["state"] == "repeated"
    assert not room.conductor.order("format_disk")


def test_the_experimenter_reads_which_objects_to_move(room):
    trials = room.session.plan.trials
    assert room.conductor.experimenter_screen()["to_move"] == trials[0].layout
    assert room.order("start")["to_move"] == {}
    room.recorder.failed = "camera left: unplugged"
    room.conductor.step()
    assert room.conductor.experimenter_screen()["to_move"] == {}  # they stand there already
    room.recorder.failed = None
    for _ in range(4):  # then they change places
        room.order("start")
        screen = room.order("stop")
    moved = {id: at for id, at in trials[4].layout.items() if trials[3].layout[id] != at}
    assert screen["to_move"] == moved
    assert moved


def test_french_is_read_in_french(tmp_path):
    room = Room(tmp_path / "study", language='"fr"')
    shown = room.conductor.participant_screen()
    assert (shown["language"], shown["words"]) == ("fr", "Préparez-vous")
    assert shown["trial"]["object"] in ("l’eau de Javel", "les biscuits", "la moutarde", "la soupe")
    assert shown["trial"]["lines"][0] == "Main droite"
    room.session.close()
