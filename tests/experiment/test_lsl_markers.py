"""Markers on the Lab Streaming Layer: a real inlet receives every event of a session."""

import json
import uuid

import pylsl

from igrip.experiment.lsl_markers import LslMarkers
from igrip.experiment.session import Session
from igrip.experiment.unattended import run_unattended
from runtime_fakes import PATIENCE, stays_open, until
from small_study import FakeRecorder, small_study


def test_an_inlet_receives_the_events_of_a_session(tmp_path):
    folder = small_study(tmp_path / "study")
    name = f"study-{uuid.uuid4().hex[:8]}"
    markers = LslMarkers(name, folder.study.name, "P01")
    outlet = stays_open(markers._outlet)
    found = pylsl.resolve_byprop("name", name, timeout=PATIENCE)
    assert (found[0].type(), found[0].channel_count()) == ("Markers", 1)
    inlet = pylsl.StreamInlet(found[0])
    inlet.open_stream(timeout=PATIENCE)
    until(outlet.have_consumers)
    plan = folder.enrol("P01", "2026-01-31")
    session = Session(folder, plan, FakeRecorder(), announce=markers.send)
    for _ in run_unattended(session):
        pass
    session.comment("tired")
    session.close()
    received = []
    until(lambda: received.extend(inlet.pull_chunk(timeout=0.05)[0]) or len(received) >= 19)
    events = [json.loads(text[0]) for text in received]
    names = [event["event"] for event in events]
    pairs = [name for name in names if name in ("trial_started", "trial_recorded")]
    assert pairs == ["trial_started", "trial_recorded"] * 8
    assert (names[0], names[-2:]) == ("session_started", ["commented", "session_ended"])
    started = [event for event in events if event["event"] == "trial_started"]
    assert [event["trial"] for event in started] == list(range(1, 9))
    assert [event["levels"] for event in started] == [dict(t.levels) for t in plan.trials]
    assert {event["participant"] for event in events} == {"P01"}
    assert "consent" not in " ".join(text[0] for text in received)


def test_a_marker_that_cannot_be_sent_costs_no_trial(tmp_path):
    folder = small_study(tmp_path / "study")
    markers = LslMarkers(f"study-{uuid.uuid4().hex[:8]}", folder.study.name, "P01")
    stays_open(markers._outlet)
    markers.close()
    plan = folder.enrol("P01", "2026-01-31")
    session = Session(folder, plan, FakeRecorder(), announce=markers.send)
    for _ in run_unattended(session):
        pass
    assert len(session.progress.done) == 8
    session.close()
