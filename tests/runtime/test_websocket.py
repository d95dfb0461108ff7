"""The server, with real clients on loopback."""

from __future__ import annotations

import functools
import json
import random
import socket
import threading
import time
import urllib.request

import msgspec
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

import igrip
from igrip.runtime.access import Access
from igrip.runtime.protocol import LARGEST
from igrip.runtime.service import Service
from igrip.runtime.websocket import BEHIND, TRY_LATER, WebSocketServer
from mutate import garbled
from support import BOX, UPRIGHT

AT_SENDING = {"age": 0, "valid_for": 0, "sent": 0}
TOKEN = "sixteen-characters-or-more"
POSE = {"model": BOX, "position": [0.3, 0.0, 0.0], "orientation": UPRIGHT}


class Running:
    """A service at work in threads of this process."""

    def __init__(self, catalog, token=None, assisted=("*",)):
        config = igrip.Config(targets="paper", commitment={"assisted": assisted, "reliability": 0})
        self.service = Service(igrip.Estimator(catalog, config))
        self.server = WebSocketServer(
            "127.0.0.1", 0, Access("127.0.0.1", token), self.service.take,
            self.service.inbox.count, self.service.status,
        )  # fmt: skip
        self.service.outputs.append(self.server)
        self.service.answer = self.server.answer
        self.thread = threading.Thread(target=self.service.run, args=(0.05,), daemon=True)
        self.thread.start()

    def address(self, path):
        return f"ws://127.0.0.1:{self.server.port}{path}"

    def client(self, path, **options):
        return connect(self.address(path), compression=None, **options)

    def close(self):
        self.service.inbox.close()
        self.thread.join(5.0)
        self.server.close()
        assert not self.thread.is_alive()


@pytest.fixture
def running(shapes):
    one = Running(shapes)
    yield one
    one.close()


def observation(k, t=None):
    position = [0.004 * k, 0.01 * random.Random(k).random(), 0.0]
    return {
        "t": 5e3 + k / 30.0 if t is None else t, "hands": {"right": {"position": position}},
        "objects": {"box": POSE},
    }  # fmt: skip


def until(condition, seconds=10.0):
    """Wait for something; it is a failure if it does not come."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_observations_in_intentions_out_as_json_and_messagepack(running):
    with (
        running.client("/intentions") as plain,
        running.client("/intentions?format=msgpack") as packed,
        running.client("/observations") as source,
    ):
        until(lambda: running.server.counts()["clients"] == 2)
        for k in range(30):
            form = json.dumps if k % 2 else msgspec.msgpack.encode
            source.send(form(observation(k)))
            time.sleep(1.0 / 60.0)
        texts = [plain.recv(timeout=5) for _ in range(30)]
        assert all(isinstance(text, str) for text in texts)  # a browser makes a blob of bytes
        seen = [json.loads(text) for text in texts]
        same = [msgspec.msgpack.decode(packed.recv(timeout=5)) for _ in range(30)]
    assert [i["seq"] for i in seen] == list(range(seen[0]["seq"], seen[0]["seq"] + 30))
    assert {i["session"] for i in seen + same} == {running.service.numbering.session}
    for a, b in zip(seen, same, strict=True):
        assert {**a, **AT_SENDING} == {**b, **AT_SENDING}
        assert 0.0 <= a["age"] < 5.0
    assert seen[-1]["target"] == "box"
    assert seen[-1]["schema"] == "igrip/1"


def test_a_lease_comes_with_how_long_it_holds(shapes):
    one = Running(shapes)
    try:
        with one.client("/intentions") as out, one.client("/observations") as source:
            until(lambda: one.server.counts()["clients"] == 1)
            granted = []
            for k in range(60):
                source.send(json.dumps(observation(k)))
                time.sleep(1.0 / 60.0)
            while len(granted) < 5:
                said = json.loads(out.recv(timeout=5))
                if said["commitment"]:
                    granted.append(said["valid_for"])
                else:
                    assert said["valid_for"] is None
            assert all(0.0 < left <= 0.15 for left in granted)
    finally:
        one.close()


def test_silence_is_noticed(running):
    with running.client("/intentions") as out, running.client("/observations") as source:
        until(lambda: running.server.counts()["clients"] == 1)
        for k in range(8):
            source.send(json.dumps(observation(k)))
            time.sleep(0.03)
        said = [json.loads(out.recv(timeout=5)) for _ in range(9)]
    assert said[-1]["status"] == "lost"


def test_words_about_the_lease_reach_the_estimator(running):
    heard = []

    def hear(word, hand):
        heard.append((word, hand))
        return []

    for word in ("veto", "confirm", "opened"):
        setattr(running.service._estimator, word, functools.partial(hear, word))
    with running.client("/intentions") as out, running.client("/observations") as source:
        out.send(json.dumps({"control": "veto", "hand": "right"}))
        until(lambda: len(heard) == 1)
        source.send(json.dumps({"control": "confirm", "hand": "left"}))
        until(lambda: len(heard) == 2)
    assert heard == [("veto", "right"), ("confirm", "left")]


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


def test_status_tells_what_was_counted(running):
    with running.client("/observations") as source:
        source.send("{")
        told = json.loads(source.recv(timeout=5))
        assert told["field"] == "message"
        source.send(json.dumps(observation(1)))

        def counted():
            url = f"http://127.0.0.1:{running.server.port}/status"
            with urllib.request.urlopen(url, timeout=5) as answer:
                status = json.load(answer)
            return status and status["incoming"].get("malformed") == 1 and status["inputs"]["hands"]

        until(counted)


def test_a_message_that_is_too_large_ends_its_sender_alone(running):
    with running.client("/observations") as source, running.client("/observations") as other:
        source.send("x" * (LARGEST + 1))
        with pytest.raises(ConnectionClosed) as caught:
            source.recv(timeout=5)
        assert caught.value.rcvd.code == 1009
        other.send(json.dumps(observation(1)))
        until(lambda: "right" in running.service._estimator.hands)


def test_a_slow_client_is_dropped_and_told_and_the_others_are_not(running):
    received = []
    slow = running.client("/intentions", max_queue=1)
    slow.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    good = running.client("/intentions")
    until(lambda: running.server.counts()["clients"] == 2)
    stop = threading.Event()

    def listen():
        while not stop.is_set():
            try:
                received.append(json.loads(good.recv(timeout=0.2))["seq"])
            except TimeoutError:
                continue

    listener = threading.Thread(target=listen)
    listener.start()
    sent = 0
    while running.server.counts().get("dropped_clients", 0) == 0:
        running.service.take(igrip.Observation(**observation(sent, t=float(sent))))
        sent += 1
        time.sleep(0.001)
        assert sent < 60_000
    until(lambda: len(running.service.inbox) == 0)
    time.sleep(0.3)
    stop.set()
    listener.join()
    until(lambda: running.server.counts()["lost"] >= BEHIND)
    assert received == list(range(received[0], received[0] + len(received)))  # not one is missing
    assert last_words(slow) in (None, TRY_LATER)
    good.close()


def last_words(client):
    """Return with which code a client was closed, once it has read what was left."""
    try:
        while True:
            client.recv(timeout=20)
    except ConnectionClosed as closed:
        return closed.rcvd and closed.rcvd.code


def fuzz(running, count, seed):
    """Send damaged messages from one client while another is served."""
    rng = random.Random(seed)
    good = running.client("/intentions")
    source, bad = running.client("/observations"), running.client("/observations")
    stop, seen = threading.Event(), []

    def live():
        k = 0
        while not stop.is_set():
            source.send(json.dumps(observation(k % 60)))
            k += 1
            time.sleep(1.0 / 30.0)

    def listen():
        while not stop.is_set():
            try:
                said = json.loads(good.recv(timeout=0.2))
            except TimeoutError:
                continue
            if said["hand"] == "right":
                seen.append(said["seq"])

    def drain():
        try:
            for _ in bad:
                pass
        except ConnectionClosed:
            pass

    threads = [threading.Thread(target=f, daemon=True) for f in (live, listen, drain)]
    for thread in threads:
        thread.start()
    for k in range(count):
        try:
            bad.send(garbled(json.dumps(observation(k)).encode(), rng))
        except ConnectionClosed:  # it may be refused, never crash
            bad = running.client("/observations")
            threading.Thread(target=drain, daemon=True).start()
    time.sleep(0.5)
    stop.set()
    for thread in threads[:2]:
        thread.join()
    bad.close()
    good.close()
    source.close()
    return seen


def test_damaged_messages_harm_nobody(running):
    seen = fuzz(running, 5_000, seed=1)
    assert len(seen) > 5
    assert running.thread.is_alive()
    assert running.service.inbox.counts["malformed"] > 1000


def test_a_veto_is_told_at_once_and_overtakes_what_waits(shapes):
    one = Running(shapes)
    told = []
    try:
        with one.client("/intentions") as out, one.client("/observations") as source:
            until(lambda: one.server.counts()["clients"] == 1)
            for k in range(60):
                source.send(json.dumps(observation(k)))
                time.sleep(1.0 / 60.0)
                if one.service._estimator.latest.get("right") and (
                    one.service._estimator.latest["right"].commitment
                ):
                    break
            out.send(json.dumps({"control": "veto", "hand": "right"}))
            begin = time.monotonic()
            while time.monotonic() - begin < 0.5:
                try:
                    told.append(json.loads(out.recv(timeout=0.1)))
                except TimeoutError:
                    continue
    finally:
        one.close()
    granted = [said["commitment"] is not None for said in told]
    last = len(granted) - 1 - granted[::-1].index(True)
    after = told[last + 1]
    assert after["commitment"] is None
    assert after["t"] == told[last]["t"]  # told without another measurement


def test_words_about_no_assisted_hand_are_answered(shapes):
    one = Running(shapes, assisted=("right",))
    try:
        with one.client("/intentions") as out:
            out.send(json.dumps({"control": "veto", "hand": "rihgt"}))
            assert "rihgt" in json.loads(out.recv(timeout=5))["error"]
    finally:
        one.close()


def test_what_is_refused_is_told_and_the_rest_goes_on(running):
    with running.client("/observations") as source:
        source.send(json.dumps({
            "t": 1.0, "hands": {"right": {"position": [0, 0, 0]}},
            "objects": {"box": {"position": [0.3, 0, 0], "orientation": UPRIGHT}},
        }))  # fmt: skip
        assert "model" in json.loads(source.recv(timeout=5))["error"]
        until(lambda: "right" in running.service._estimator.hands)
