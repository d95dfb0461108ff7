"""Open Sound Control, sent by a real client over UDP."""

from __future__ import annotations

import json
import socket

import pytest
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.udp_client import SimpleUDPClient

import igrip
from igrip.errors import IgripError
from igrip.io.frames import DeclaredFrame
from igrip.runtime.clock_sync import ArrivalClock
from igrip.runtime.inputs.osc import OscInput, name_and_numbers
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from runtime_fakes import Clock, Collector, until
from support import BOX

POSE = [0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


class Running:
    """A loop that is stepped by the test, and a client of its OSC port."""

    def __init__(self, catalog, **options):
        self.clock, self.output, self.warnings = Clock(), Collector(), []
        self.input = OscInput(Options(osc_port=0, **options))
        self.loop = Loop(
            igrip.Estimator(catalog), ArrivalClock(clock=self.clock), {"osc": self.input},
            {"out": self.output}, warn=self.warnings.append,
        )  # fmt: skip
        self.loop.__enter__()
        self.client = SimpleUDPClient("127.0.0.1", self.input.port)

    def take(self):
        """Wait for one message, and let the loop handle it."""
        until(lambda: len(self.loop._queue))
        self.clock.t += 1.0 / 30.0
        self.loop.step(0.0)
        return self.loop.estimator.inputs()

    def close(self):
        self.client._sock.close()  # the package has no other way
        self.loop.__exit__()


@pytest.fixture
def running(shapes):
    one = Running(shapes)
    yield one
    one.close()


def test_a_name_and_three_numbers_are_a_hand_and_seven_an_object(running):
    running.client.send_message(f"/{BOX}", POSE)
    running.take()
    for k in range(12):
        running.client.send_message("/RightHand", [0.004 * k, 0.001 * (k % 3), 0.0])
        inputs = running.take()
    assert inputs["objects"][BOX]["usable"]
    assert inputs["hands"]["right"]["status"] in ("idle", "reaching")
    assert running.output.intentions[-1].hand == "right"


def test_a_bundle_is_one_message(running):
    bundle = OscBundleBuilder(IMMEDIATELY)
    for address, numbers in (("/hand/left", [0.0, 0.1, 0.1]), (f"/object/{BOX}", POSE)):
        message = OscMessageBuilder(address)
        for number in numbers:
            message.add_arg(float(number))
        bundle.add_content(message.build())
    running.client.send(bundle.build())
    inputs = running.take()
    assert set(inputs["hands"]) == {"left"}
    assert set(inputs["objects"]) == {BOX}
    assert inputs["counts"]["messages"] == 1


def test_vmc_trackers_have_their_name_as_an_argument(running):
    running.client.send_message("/VMC/Ext/Tra/Pos", ["hand_right", *POSE])
    assert set(running.take()["hands"]) == {"right"}


def test_json_may_be_sent_as_text(running):
    line = json.dumps({"t": 1.0, "hands": {"left": {"position": [0.0, 0.0, 0.1]}}})
    running.client.send_message("/anything", line)
    assert set(running.take()["hands"]) == {"left"}


def test_what_cannot_be_is_named_with_what_would_do(running):
    for address, numbers in (("/hand_0", [0.0, 0.1, 0.1]), ("/mug", [0.0, 0.1, 0.1]),
                             ("/right", [0.0, 0.1])):  # fmt: skip
        running.client.send_message(address, numbers)
    until(lambda: len(running.warnings) == 3)
    assert "'hand_0' is none of the hands left, right" in running.warnings[0]
    assert "'mug' is no hand (left, right), and an object needs a rotation" in running.warnings[1]
    assert "has 2 numbers" in running.warnings[2]


def test_noise_is_counted_and_harms_nothing(running):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for data in (b"", b"nonsense", b"#bundle\0", b"/x\0\0,f\0\0", bytes(100)):
            sender.sendto(data, ("127.0.0.1", running.input.port))
    running.client.send_message("/left", [0.0, 0.1, float("nan")])
    running.client.send_message("/right", [0.0, 0.1, 0.2])
    running.take()
    assert set(running.take()["hands"]) == {"right"}


def test_a_declared_frame_is_converted(shapes):
    frame = DeclaredFrame.declare(up="y", length_unit="mm", time_unit="ms")
    one = Running(shapes, frame=frame)
    try:
        one.client.send_message("/right", [100.0, 50.0, -300.0])
        one.take()
        position = one.loop.estimator.hands["right"].gate.position
        assert position == pytest.approx((0.1, 0.3, 0.05))
    finally:
        one.close()


def test_a_port_that_is_taken_is_named(running):
    with pytest.raises(IgripError, match=str(running.input.port)):
        OscInput(Options(osc_port=running.input.port)).start(running.loop)


@pytest.mark.parametrize(("address", "params", "name"), [
    ("/hand/right/position", [1.0, 2.0, 3.0], "right"), ("/vrpn/mug/pose", POSE, "mug"),
    ("/tracker1", ["R", 1.0, 2.0, 3.0], "R"), ("/rigidbody", [1, 2, 3], "rigidbody"),
])  # fmt: skip
def test_names_in_addresses(address, params, name):
    assert name_and_numbers(address, params)[0] == name
