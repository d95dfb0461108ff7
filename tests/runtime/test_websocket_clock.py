"""A sender whose clock steps, through the real WebSocket input; time is that of the test."""

from __future__ import annotations

import json
import urllib.request

import pytest
from websockets.exceptions import InvalidStatus

from running_server import POSE, Running, receive
from runtime_fakes import until


@pytest.fixture
def running(shapes):
    one = Running(shapes)
    yield one
    one.close()


def feed(running, source, out, k, step):
    """Send a message of a reach, dated by a clock that is off by a step, and return the answer."""
    running.clock.t += 1.0 / 30.0
    position = [0.002 * k, 0.001 * (k % 3), 0.0]
    source.send(json.dumps({
        "t": 5e3 + k / 30.0 + step, "hands": {"right": {"position": position}},
        "objects": {"box": POSE},
    }))  # fmt: skip
    return receive(out)


def status(running):
    running.loop._update_report()
    url = f"http://127.0.0.1:{running.server.port}/status"
    with urllib.request.urlopen(url) as answer:
        return json.loads(answer.read())


@pytest.mark.parametrize("step", [-0.25, -0.5, -0.9, -3600.0, 0.3, 0.7, 86400.0])
def test_a_step_costs_a_moment_and_is_named_everywhere(running, step):
    with running.listener() as out, running.client("/observations") as source:
        before = [feed(running, source, out, k, 0.0) for k in range(45)]
        after = [feed(running, source, out, k, step) for k in range(45, 75)]
    assert any(message["commitment"] for message in before)
    unsure = [message for message in after if message["status"] == "invalid"]
    direction = "back" if step < 0.0 else "ahead"
    assert 1 <= len(unsure) <= 8
    assert all(message["commitment"] is None for message in unsure)
    assert all(f"stepped {direction} by about" in message["reason"] for message in unsure)
    assert all(message["status"] == "reaching" for message in after[-10:])
    assert any(message["commitment"] for message in after[len(unsure) :])
    assert any(f"stepped {direction} by" in text for text in running.warnings)
    [sender] = status(running)["senders"].values()
    assert sender["clock"]["steps"] == 1
    assert sender["clock"]["followed"] is True
    assert f"stepped {direction} by" in sender["clock"]["event"]


def test_what_is_not_seen_is_counted_at_status_and_named_in_the_reason(running):
    with running.listener() as out, running.client("/observations") as source:
        for k in range(5):
            feed(running, source, out, k, 0.0)
        for k in range(5, 20):
            before = running.loop.estimator.inputs()["counts"]["messages"]
            lost = {"right": {"position": [float("nan"), 0.0, 0.0]}}
            source.send(json.dumps({"t": 5e3 + k / 30.0, "hands": lost}))
            until(lambda: running.loop.estimator.inputs()["counts"]["messages"] > before)  # noqa: B023
            running.clock.t += 1.0 / 30.0
        message = receive(out)
        while message["status"] != "lost":
            message = receive(out)
    assert "position[0]: must be finite, got nan" in message["reason"]
    [sender] = status(running)["senders"].values()
    [defect] = sender["defects"]
    assert (defect["what"], defect["path"], defect["count"]) == ("not seen", "hands.right", 15)


def test_times_in_milliseconds_permit_nothing_and_name_the_option(running):
    with running.listener() as out, running.client("/observations") as source:
        for k in range(60):
            running.clock.t += 1.0 / 30.0
            hands = {"right": {"position": [0.002 * k, 0.001 * (k % 3), 0.0]}}
            source.send(json.dumps({"t": 1e3 * k / 30.0, "hands": hands, "objects": {"box": POSE}}))
            message = receive(out)
            assert message["commitment"] is None
    assert message["status"] == "invalid"
    assert "--time-unit ms" in message["reason"]
    assert any("--time-unit ms" in text for text in running.warnings)


def test_a_page_from_disk_learns_how_it_can_connect(running):
    with pytest.raises(InvalidStatus) as refused:
        running.client("/observations", origin="null")
    response = refused.value.response
    assert response.status_code == 403
    assert b"opened from disk" in response.body
    assert b"?token=" in response.body
    assert any("opened from disk" in text for text in running.warnings)
