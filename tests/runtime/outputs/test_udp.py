"""Datagrams, received by a plain socket."""

from __future__ import annotations

import json
import socket

import pytest

from igrip.errors import IgripError
from igrip.runtime.options import Options
from igrip.runtime.outputs.udp import UdpOutput
from runtime_fakes import PATIENCE
from wire import PERMITTED, STORY, FakeLoop, envelopes


@pytest.fixture
def receiver():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        one.settimeout(PATIENCE)
        yield one


def started(address, loop=None):
    output = UdpOutput(Options(udp_to=address))
    output.start(loop or FakeLoop())
    return output


def test_each_intention_is_a_datagram_with_what_is_left_of_its_lease(receiver):
    output = started(f"127.0.0.1:{receiver.getsockname()[1]}")
    for envelope in envelopes():
        output.send(envelope)
    messages = [json.loads(receiver.recv(65_536)) for _ in STORY]
    assert [message["status"] for message in messages] == [one.status for one in STORY]
    assert [message["seq"] for message in messages] == [1, 2, 3]
    assert [message["valid_for"] or 0.0 for message in messages] == pytest.approx(PERMITTED)
    assert output.counts() == {"sent": 3, "lost": 0}
    output.close()


def test_a_receiver_that_is_gone_costs_messages_and_nothing_else(receiver):
    address = f"127.0.0.1:{receiver.getsockname()[1]}"
    receiver.close()
    output = started(address)
    for _ in range(20):
        for envelope in envelopes():
            output.send(envelope)
    assert sum(output.counts().values()) == 20 * len(STORY)
    output.close()
    output.close()


def test_what_is_too_large_for_a_datagram_is_lost_and_counted(receiver):
    output = started(f"127.0.0.1:{receiver.getsockname()[1]}")
    output._socket.send(bytes(70_000))
    assert output.counts() == {"sent": 0, "lost": 1}
    output.close()


@pytest.mark.parametrize("address", ["9870", "127.0.0.1:", "127.0.0.1:port", "a:0", "a:70000"])
def test_what_is_no_address_is_named(address):
    with pytest.raises(IgripError, match="--udp-to"):
        UdpOutput(Options(udp_to=address))
