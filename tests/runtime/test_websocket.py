"""The server, with real clients on loopback; time is that of the test."""

from __future__ import annotations

import gc
import json
import random
import threading
import urllib.request

import msgspec
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from igrip.intention import Intention
from igrip.runtime.envelope import Sequencer
from igrip.runtime.protocol import MAX_SIZE
from igrip.runtime.websocket import MAX_BEHIND, TRY_LATER, _Client
from random_damage import garbled
from running_server import POSE, Running, observation, receive
from runtime_fakes import PATIENCE, until
from support import UPRIGHT

AT_SENDING = {"age": 0, "valid_for": 0, "sent": 0}
TOKEN = "sixteen-characters-or-more"


@pytest.fixture
def running(shapes):
    one = Running(shapes)
    yield one
    one.close()


def incoming(running):
    return running.loop._queue.report()


def test_observations_in_intentions_out_as_json_and_messagepack(running):
    with (
        running.listener() as plain,
        running.listener("/intentions?format=msgpack") as packed,
        running.client("/observations") as source,
    ):
        for k in range(30):
            running.feed(source, k, json.dumps if k % 2 else msgspec.msgpack.encode)
        texts = [plain.recv(timeout=PATIENCE) for _ in range(30)]
        assert all(isinstance(text, str) for text in texts)  # a browser makes a blob of bytes
        messages = [json.loads(text) for text in texts]
        same = [msgspec.msgpack.decode(packed.recv(timeout=PATIENCE)) for _ in range(30)]
    assert [message["seq"] for message in messages] == list(range(1, 31))
    assert {message["session"] for message in messages + same} == {running.loop.session}
    for a, b in zip(messages, same, strict=True):
        assert {**a, **AT_SENDING} == {**b, **AT_SENDING}
        assert a["age"] >= 0.0
    assert messages[-1]["target"] == "box"
    assert messages[-1]["schema"] == "igrip/1"


def test_a_lease_comes_with_how_long_it_holds(running):
    granted = []
    with running.listener() as out, running.client("/observations") as source:
        for k in range(60):
            running.feed(source, k)
            message = receive(out)
            if message["commitment"]:
                granted.append(message["valid_for"])
            else:
                assert message["valid_for"] is None
    assert len(granted) > 5
    assert granted == pytest.approx([0.15] * len(granted), abs=0.002)  # less a drift of the clock


def test_silence_is_noticed(running):
    with running.listener() as out, running.client("/observations") as source:
        for k in range(8):
            running.feed(source, k)
        for _ in range(8):
            assert receive(out)["status"] != "lost"
        for _ in range(10):
            running.pass_time(0.051)
        assert receive(out)["status"] == "lost"


def test_commands_reach_the_estimator_on_both_paths(running):
    calls = []

    def method(name):
        def call(hand):
            calls.append((name, hand))
            return []

        return call

    for name in ("veto", "confirm", "notify_released"):
        setattr(running.loop.estimator, name, method(name))
    with running.client("/intentions") as out, running.client("/observations") as source:
        out.send(json.dumps({"control": "veto", "hand": "right"}))
        until(lambda: len(calls) == 1)
        source.send(json.dumps({"control": "confirm", "hand": "left"}))
        until(lambda: len(calls) == 2)
        out.send(json.dumps({"control": "opened"}))
        until(lambda: len(calls) == 3)
    assert calls == [("veto", "right"), ("confirm", "left"), ("notify_released", None)]


@pytest.mark.parametrize("observations", [True, False])
def test_observations_are_refused_where_intentions_go_out(shapes, observations):
    one = Running(shapes, observations=observations)
    try:
        with one.listener() as out:
            out.send(json.dumps(observation(1)))
            assert "not accepted" in receive(out)["error"]
            out.send(json.dumps({"control": "veto", "hand": "right"}))
            until(lambda: incoming(one).get("veto"))
        assert incoming(one) == {"received": 1, "refused": 1, "veto": 1, "waiting": 0}
        assert one.loop.estimator.hands == {}
    finally:
        one.close()


def test_observations_have_no_path_where_they_are_no_input(shapes):
    one = Running(shapes, observations=False)
    try:
        with pytest.raises(InvalidStatus) as caught:
            one.client("/observations")
        assert caught.value.response.status_code == 404
    finally:
        one.close()


def test_without_the_token_nobody_gets_in(shapes):
    one = Running(shapes, TOKEN)
    try:
        for path in ("/intentions", "/observations", f"/intentions?token={TOKEN}x"):
            with pytest.raises(InvalidStatus) as caught:
                one.client(path)
            assert caught.value.response.status_code == 403
        with one.client(f"/intentions?token={TOKEN}"):
            pass
        with one.client("/observations", additional_headers={"Authorization": f"Bearer {TOKEN}"}):
            pass
    finally:
        one.close()


@pytest.mark.parametrize(("path", "origin", "code"), [
    ("/observations", "https://evil.example", 403), ("/elsewhere", None, 404),
])  # fmt: skip
def test_strange_requests_are_answered(running, path, origin, code):
    with pytest.raises(InvalidStatus) as caught:
        running.client(path, origin=origin)
    assert caught.value.response.status_code == code


def test_status_reports_the_counts(running):
    with running.client("/observations") as source:
        source.send("{")
        assert receive(source)["field"] == "message"
        running.feed(source, 1)

        def counted():
            url = f"http://127.0.0.1:{running.server.port}/status"
            with urllib.request.urlopen(url, timeout=PATIENCE) as answer:
                status = json.load(answer)
            return status["incoming"].get("malformed") == 1 and status["inputs"]["hands"]

        until(counted)


def test_a_message_that_is_too_large_ends_its_sender_alone(running):
    with running.client("/observations") as source, running.client("/observations") as other:
        source.send("x" * (MAX_SIZE + 1))
        with pytest.raises(ConnectionClosed) as caught:
            source.recv(timeout=PATIENCE)
        assert caught.value.rcvd.code == 1009
        running.feed(other, 1)
        assert "right" in running.loop.estimator.hands
    until(lambda: incoming(running).get("too_large") == 1)


def test_a_client_that_is_too_slow_is_dropped_and_the_others_are_not(running):
    slow = running.client("/intentions", max_queue=1, close_timeout=1)
    good = running.listener()
    until(lambda: running.server.counts()["clients"] == 2)
    sequencer, received = Sequencer(running.clock), []
    large = Intention(t=0.0, hand="right", status="idle", reason="x" * 20_000)
    while running.server.counts().get("dropped_clients", 0) == 0:
        running.server.send(sequencer.wrap(large, 0.0))
        received.append(receive(good)["seq"])
        assert len(received) < 60_000
    assert received == list(range(1, len(received) + 1))  # not one is missing
    until(lambda: running.server.counts()["lost"] >= MAX_BEHIND)
    assert running.server.counts()["clients"] == 1
    assert close_code(slow) in (None, TRY_LATER)
    good.close()


def close_code(client):
    """Return the code that a client was closed with, once it has read the rest."""
    try:
        while True:
            client.recv(timeout=PATIENCE)
    except ConnectionClosed as closed:
        return closed.rcvd and closed.rcvd.code


def test_damaged_messages_harm_nobody(running):
    rng, count = random.Random(1), 5_000
    good, source, bad = running.listener(), running.client("/observations"), None
    answered = 0
    for k in range(count):
        if bad is None:
            bad = running.client("/observations")
            threading.Thread(target=drain, args=(bad,), daemon=True).start()
        try:
            bad.send(garbled(json.dumps(observation(k)).encode(), rng))
        except ConnectionClosed:  # it may be refused, never crash
            bad = None
        if k % 500 == 0:
            running.feed(source, k)
            answered += "seq" in receive(good)
    for client in (bad, good, source):
        if client is not None:
            client.close()
    assert answered == count / 500
    assert running.thread.is_alive()
    assert incoming(running)["malformed"] > 1000


def drain(client):
    try:
        for _ in client:
            pass
    except ConnectionClosed:
        pass


def test_a_veto_is_sent_at_once(running):
    with running.listener() as out, running.client("/observations") as source:
        for k in range(60):
            running.feed(source, k)
            granted = receive(out)
            if granted["commitment"]:
                break
        out.send(json.dumps({"control": "veto", "hand": "right"}))
        after = receive(out)
    assert granted["commitment"] is not None
    assert after["commitment"] is None
    assert after["t"] == granted["t"]  # without another measurement


def test_commands_for_a_hand_that_is_not_assisted_are_answered(shapes):
    one = Running(shapes, assisted=("right",))
    try:
        with one.client("/intentions") as out:
            out.send(json.dumps({"control": "veto", "hand": "rihgt"}))
            assert "rihgt" in receive(out)["error"]
    finally:
        one.close()


def test_a_refused_object_is_answered_and_the_rest_is_used(running):
    with running.client("/observations") as source:
        source.send(json.dumps({
            "t": 1.0, "hands": {"right": {"position": [0, 0, 0]}},
            "objects": {"box": {"position": [0.3, 0, 0], "orientation": UPRIGHT}},
        }))  # fmt: skip
        assert "model" in receive(source)["error"]
        until(lambda: "right" in running.loop.estimator.hands)


def test_nothing_is_kept_of_clients_that_have_gone(shapes):
    """Also if their last messages are malformed, or refused after they have gone."""
    one = Running(shapes, works=False)
    refused = observation(0) | {"objects": {"x": {k: POSE[k] for k in ("position", "orientation")}}}
    try:
        for _ in range(20):
            with one.client("/observations") as source, one.listener() as out:
                for client in (source, out):
                    client.send("{")
                    client.send("{")
                source.send(json.dumps(refused))
                until(lambda: len(one.loop._queue) == 1)
            until(lambda: not one.server._clients)
            one.clock.t += 0.01
            one.loop.step(0.0)
            one.server.send(Sequencer(one.clock).wrap(Intention(t=0.0, hand="h", status="idle"), 0))
        assert incoming(one)["refused"] == 20
        assert incoming(one)["malformed"] == 80

        def kept():
            gc.collect()
            return [one for one in gc.get_objects() if isinstance(one, _Client)]

        until(lambda: not kept())
        assert one.server.counts()["clients"] == 0
        until(lambda: not one.server._background)
    finally:
        one.close()
