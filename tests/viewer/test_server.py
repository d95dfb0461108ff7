"""The page never slows the estimator, misses no decision, and answers only to this machine."""

from __future__ import annotations

import json
import socket
import threading
import time
import urllib.error
import urllib.request
from dataclasses import replace

import pytest

pytest.importorskip("websockets", reason="the extra 'viewer' is not installed")
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from igrip import load_objects
from igrip.errors import IgripError
from igrip.runtime.protocol import Command
from igrip.viewer.page_messages import row_of_hand
from igrip.viewer.server import Viewer
from moments import demo_moments


@pytest.fixture(scope="module")
def moments():
    """The demo until a hand reaches with rays that meet its target."""
    return demo_moments(load_objects("ycb"))


@pytest.fixture
def viewer():
    viewer = Viewer(port=0, targets="bayes", choose_targets=lambda name: None)
    yield viewer
    viewer.close()


def wait_for(condition, seconds=60.0):
    deadline = time.monotonic() + seconds
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert condition()


def open_socket(viewer, **options):
    return connect(viewer.url.replace("http", "ws") + "/socket", **options)


def receive(page, until, most=500):
    """Return the messages of a page up to the first that meets a condition."""
    found = []
    for _ in range(most):
        found.append(json.loads(page.recv(timeout=60)))
        if until(found[-1]):
            return found
    raise AssertionError("it did not come")


def status_of(url, headers=None):
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers or {}), timeout=20):
            return 200
    except urllib.error.HTTPError as refusal:
        refusal.close()
        return refusal.code


def test_show_never_waits(viewer, moments):
    """While a drawing takes for ever, snapshots are dropped and counted, and nobody waits."""
    drawing, go_on = threading.Event(), threading.Event()

    def endless(*args):
        drawing.set()
        go_on.wait(60)

    viewer._draw = endless
    viewer.show(moments[-1])
    assert drawing.wait(60)
    for _ in range(2000):
        viewer.show(moments[-1])
    go_on.set()
    wait_for(lambda: viewer.drawn >= 2)
    assert viewer.dropped == 1999  # all came while the first was drawn; the newest is next
    assert viewer.drawn == 2


def test_the_estimator_decides_the_same_with_a_page(viewer):
    alone = demo_moments(load_objects("ycb"))
    shown = demo_moments(load_objects("ycb"), each=viewer.show)
    said = [[h.intention for h in m.hands] for m in alone]
    assert said == [[h.intention for h in m.hands] for m in shown]


def test_a_snapshot_that_cannot_be_drawn_does_not_end_the_page(viewer, moments):
    draw, tried = viewer._draw, threading.Event()

    def fail(*args):
        tried.set()
        raise ZeroDivisionError

    viewer._draw = fail
    viewer.show(moments[0])
    assert tried.wait(60)
    viewer._draw = draw
    viewer.show(moments[1])
    wait_for(lambda: viewer.drawn >= 1)


def test_no_row_is_missed_however_fast_they_come(viewer, moments):
    """Drawings are dropped; what was decided is not, for a page that was open or comes later."""
    expected = [row_of_hand(h) for m in moments for h in m.hands if h.intention.t == m.t]
    for number in range(2):
        with open_socket(viewer) as page:
            if number == 0:
                for moment in moments:
                    viewer.show(moment)
            rows = []
            while len(rows) < len(expected):
                [*_, message] = receive(page, lambda m: m["kind"] == "rows")
                rows = message["rows"] if message.get("reset") else rows + message["rows"]
            assert rows == json.loads(json.dumps(expected))


def test_a_clock_that_begins_anew_begins_the_charts_anew(viewer, moments):
    with open_socket(viewer) as page:
        viewer.show(moments[-1])
        receive(page, lambda m: m["kind"] == "scene")
        viewer.show(replace(moments[0], t=moments[0].t))
        [*_, message] = receive(page, lambda m: m["kind"] == "rows")
        assert message["reset"]
        assert {row["t"] for row in message["rows"]} <= {round(moments[0].t, 5)}


def test_history_is_bounded(viewer, moments):
    for k in range(5000):
        viewer.show(replace(moments[-1], t=100.0 + k * 0.005))
    assert len(viewer._pending) <= 10_000
    wait_for(lambda: not viewer._waiting._items)
    assert len(viewer._server._rows) <= 2000 + 2 * len(moments[-1].hands)


def test_commands_of_a_person_arrive_and_nothing_else_does(moments):
    commands, chosen = [], []
    viewer = Viewer(port=0, targets="bayes", choose_targets=chosen.append,
                    on_command=commands.append)  # fmt: skip
    try:
        with open_socket(viewer) as page:
            for text in (
                '{"control": "veto", "hand": "right"}', '{"control": "explode", "hand": "right"}',
                '{"control": "veto"}', '{"control": "veto", "hand": 3}', "[]", "{", "null", "\x00",
                '{"targets": "nonsense"}', '{"targets": ["bayes"]}', "[" * 2000,
                '{"targets": "paper"}', '{"control": "confirm", "hand": "left"}',
            ):  # fmt: skip
                page.send(text)
            wait_for(lambda: len(commands) == 2)
    finally:
        viewer.close()
    assert commands == [Command("veto", "right"), Command("confirm", "left")]
    assert chosen == ["paper"]


def test_pages_of_other_sites_are_refused(viewer):
    with pytest.raises(InvalidStatus):
        open_socket(viewer, origin="https://example.org")
    for path in ("/", "/picture/desk", "/socket"):
        assert status_of(viewer.url + path, {"Host": "example.org"}) == 403  # a name led here


@pytest.mark.parametrize("path", ["/none.js", "/../server.py", "/%2e%2e/server.py", "/static/../"])
def test_no_other_file_is_served(viewer, path):
    assert status_of(viewer.url + path) == 404


def test_the_page_loads_nothing_from_elsewhere(viewer):
    with urllib.request.urlopen(viewer.url, timeout=20) as answer:
        policy = answer.headers["Content-Security-Policy"]
        text = answer.read().decode()
    assert "default-src 'self'" in policy
    assert "//" not in text.replace("<!doctype html>", "")


def test_a_busy_port_is_refused(viewer):
    with pytest.raises(IgripError, match="cannot listen on"):
        Viewer(port=int(viewer.url.rpartition(":")[2]))


def test_a_page_for_other_machines_is_refused():
    with pytest.raises(IgripError, match="token"):
        Viewer(host="0.0.0.0", port=0)


def test_close_frees_the_port():
    viewer = Viewer(port=0)
    port = int(viewer.url.rpartition(":")[2])
    viewer.close()
    with socket.create_server(("127.0.0.1", port)) as other:
        assert other.getsockname()[1] == port
