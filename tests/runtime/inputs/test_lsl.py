"""Motion capture on the Lab Streaming Layer, from real outlets."""

from __future__ import annotations

import json
import uuid

import pylsl
import pytest

import igrip
from igrip.runtime.clock_sync import ArrivalClock
from igrip.runtime.inputs._named_poses import Layout, NamedPoses, channel_of
from igrip.runtime.inputs.lsl import LslInput
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from runtime_fakes import OPEN, PATIENCE, Clock, Collector, stays_open, until
from support import BOX

RIGHT = [{"label": f"r{axis}", "object": "RightHand", "type": f"Position{axis}",
          "unit": "millimeters"} for axis in "XYZ"]  # fmt: skip
OBJECT = [
    {"label": f"{BOX}.{part}", "unit": "mm"} for part in ("x", "y", "z", "qx", "qy", "qz", "qw")
]


def outlet(name, channels, source="", kind="MoCap", form="float32"):
    info = pylsl.StreamInfo(name, kind, len(channels), pylsl.IRREGULAR_RATE, form, source)
    node = info.desc().append_child("channels")
    for channel in channels:
        child = node.append_child("channel")
        for key, value in channel.items():
            child.append_child_value(key, value)
    return stays_open(pylsl.StreamOutlet(info))


class Running:
    """A loop that is stepped by the test, on a clock that it sets."""

    def __init__(self, catalog, name, **options):
        self.clock, self.output, self.notes = Clock(), Collector(), []
        self.input = LslInput(Options(source_name=name, **options))
        self.loop = Loop(
            igrip.Estimator(catalog), ArrivalClock(clock=self.clock), {"lsl": self.input},
            {"out": self.output}, announce=self.notes.append, warn=self.notes.append,
        )  # fmt: skip
        self.loop.__enter__()

    def push(self, outlet, sample, t):
        """Push a sample, wait for it, and let the loop handle it."""
        outlet.push_sample(sample, t)
        until(lambda: len(self.loop._queue))
        self.loop.step(0.0)

    def close(self):
        self.loop.__exit__()


@pytest.fixture
def name():
    return f"igrip-test-{uuid.uuid4().hex[:8]}"


@pytest.fixture
def running(shapes, name):
    one = Running(shapes, name)
    yield one
    one.close()


def sample(k):
    return [4.0 * k, 1.0 * (k % 3), 0.0, 300.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def test_hands_and_objects_by_the_metadata_of_the_channels(running, name):
    source = outlet(name, RIGHT + OBJECT)
    assert source.wait_for_consumers(PATIENCE)
    for k in range(12):
        running.clock.t = 0.01 * k  # at an irregular rate, by the sender's stamps
        running.push(source, sample(k), 1e4 + running.clock.t)
    inputs = running.loop.estimator.inputs()
    assert inputs["objects"][BOX]["usable"]
    hand = running.loop.estimator.hands["right"]
    assert hand.gate.position == pytest.approx((0.044, 0.002, 0.0))
    assert any("hands right" in note for note in running.notes)
    [sender] = running.loop.senders.report().values()
    assert sender["clock"]["followed"]


def test_a_stepped_clock_is_followed(running, name):
    source = outlet(name, RIGHT + OBJECT)
    assert source.wait_for_consumers(PATIENCE)
    for k in range(60):
        running.clock.t = k / 30.0
        running.push(source, sample(k), 1e4 + running.clock.t - (0.5 if k >= 30 else 0.0))
    statuses = [i.status for i in running.output.intentions if i.hand == "right"]
    assert 4 <= statuses.count("invalid") <= 8
    assert statuses[-1] in ("idle", "reaching")
    assert any("stepped back by 0.500 s" in note for note in running.notes)


def test_a_sender_that_comes_again_is_found_again(running, name):
    for clock in (1e4, 2e4):
        source = outlet(name, RIGHT, source=f"{name}-{clock}")
        assert source.wait_for_consumers(PATIENCE)
        running.clock.t += 1.0
        running.push(source, [1.0, 2.0, 3.0], clock)
        assert running.loop.estimator.hands["right"].status == "warming_up"
        OPEN.remove(source)
        del source
    until(lambda: running.loop._queue.counts["reconnections"] >= 2)


def test_text_is_observations(running, name):
    source = outlet(name, [{}], form="string")
    assert source.wait_for_consumers(PATIENCE)
    line = json.dumps({"t": 5.0, "hands": {"left": {"position": [0.1, 0.2, 0.3]}}})
    running.push(source, [line], 1e4)
    assert set(running.loop.estimator.inputs()["hands"]) == {"left"}


@pytest.mark.parametrize(("channels", "words"), [
    ([{}, {}, {}], "label them right.x"),
    ([{"label": f"hand_0.{axis}"} for axis in "xyz"], "'hand_0' is none of the hands left, right"),
])  # fmt: skip
def test_what_cannot_be_read_is_named_with_what_would_do(running, name, channels, words):
    outlet(name, channels)
    until(lambda: any(words in note for note in running.notes))
    assert not any("\n" in note for note in running.notes)  # a line each


@pytest.mark.parametrize(("metadata", "expected"), [
    ({"label": "right.x"}, ("right", "x", None)),
    ({"label": "mug_qw"}, ("mug", "qw", None)),
    ({"label": "Right Hand Position Z", "unit": "m"}, ("Right Hand", "z", 1.0)),
    ({"label": "mug/orientation/x"}, ("mug", "qx", None)),
    ({"label": "mug w"}, ("mug", "qw", None)),
    ({"label": "c7", "marker": "R", "type": "PositionY", "unit": "meters"}, ("R", "y", 1.0)),
    ({"label": "o", "object": "mug", "type": "OrientationW"}, ("mug", "qw", None)),
    ({"label": "emg1"}, None), ({"label": "x"}, None), ({}, None),
])  # fmt: skip
def test_channels(metadata, expected):
    assert channel_of(metadata) == expected


@pytest.mark.parametrize(("unit", "metres"), [("mm", 0.001), ("inches", 0.0254), ("dm", 0.1)])
def test_channels_of_several_units_are_metres(unit, metres):
    hand = [{"label": f"right.{axis}", "unit": unit} for axis in "xyz"]
    mug = [
        {"label": f"mug.{part}", "unit": "m"} for part in ("x", "y", "z", "qx", "qy", "qz", "qw")
    ]
    poses = NamedPoses(["right"])
    alone = Layout(map(channel_of, hand))
    assert alone.metres == metres
    assert alone.message(0.0, [1.0, 2.0, 3.0], poses)["hands"]["right"]["position"] == [1, 2, 3]
    both = Layout(map(channel_of, hand + mug))
    assert (both.metres, both.is_converted) == (1.0, True)
    message = both.message(0.0, [1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 0, 0, 0, 1], poses)
    assert message["hands"]["right"]["position"] == pytest.approx([metres, 2 * metres, 3 * metres])
    assert message["objects"]["mug"]["position"] == [0.1, 0.2, 0.3]
