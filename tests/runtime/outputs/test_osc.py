"""Bundles of Open Sound Control, read by the package's own parser."""

from __future__ import annotations

import socket

import pytest
from pythonosc.osc_packet import OscPacket

from igrip.intention import Intention
from igrip.runtime.envelope import Sequencer
from igrip.runtime.options import Options
from igrip.runtime.outputs.osc import UNKNOWN, OscOutput
from runtime_fakes import PATIENCE
from wire import PERMITTED, STORY, FakeLoop, envelopes


@pytest.fixture
def line():
    """Return an output, and a function that receives one bundle as a dictionary."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(PATIENCE)
        output = OscOutput(Options(osc_to=f"127.0.0.1:{receiver.getsockname()[1]}"))
        output.start(FakeLoop())

        def receive():
            messages = [timed.message for timed in OscPacket(receiver.recv(65_536)).messages]
            return {message.address: message.params[0] for message in messages}

        yield output, receive
        output.close()


def test_a_bundle_holds_one_intention(line):
    output, receive = line
    for envelope in envelopes():
        output.send(envelope)
    idle, reaching, lost = [receive() for _ in STORY]
    assert idle["/igrip/right/status"] == "idle"
    assert (idle["/igrip/right/target"], idle["/igrip/right/confidence"]) == ("", UNKNOWN)
    assert reaching["/igrip/right/target"] == reaching["/igrip/right/permitted_target"] == "mug"
    assert reaching["/igrip/right/confidence"] == 0.875  # of a power of two: exact as float32
    assert reaching["/igrip/right/none"] == 0.125
    assert lost["/igrip/right/permitted_target"] == ""
    permitted = [one["/igrip/right/permitted_for"] for one in (idle, reaching, lost)]
    assert permitted == pytest.approx(PERMITTED)
    assert [one["/igrip/right/seq"] for one in (idle, reaching, lost)] == [1, 2, 3]


def test_a_name_cannot_change_what_an_address_means(line):
    output, receive = line
    told = Intention(t=0.0, hand="right/*{a,b} #", status="idle")
    output.send(Sequencer(lambda: 0.0).wrap(told, 0.0))
    assert all(address.startswith("/igrip/right___a_b___/") for address in receive())
