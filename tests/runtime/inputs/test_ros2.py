"""Observations from ROS 2, published by a node in another process."""

from __future__ import annotations

import pytest

import igrip
from igrip.runtime.clock_sync import ArrivalClock
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from ros import domain, needs_ros, peer  # noqa: F401
from runtime_fakes import Collector, until
from support import BOX

pytestmark = needs_ros


@pytest.fixture
def running(domain, shapes):  # noqa: F811
    from igrip.runtime.inputs.ros2 import Ros2Input

    announced, warnings = [], []
    loop = Loop(
        igrip.Estimator(shapes), ArrivalClock(), {"ros2": Ros2Input(Options())},
        {"out": Collector()}, announce=announced.append, warn=warnings.append,
    )  # fmt: skip
    with loop:
        yield loop, announced, warnings


def test_poses_and_transforms_of_another_node_become_hands_and_objects(running):
    loop, announced, _ = running

    def seen():
        loop.step(0.01)
        inputs = loop.estimator.inputs()
        return {*inputs["hands"]} == {"right"} and {*inputs["objects"]} == {BOX}

    with peer("speak", BOX):
        until(seen)
    assert any("/right_hand/pose (geometry_msgs/msg/PoseStamped)" in line for line in announced)
    report = loop.status()
    assert report["incoming"].get("malformed", 0) == 0


def test_bytes_that_are_no_message_are_counted(running):
    loop, _, warnings = running
    ros2 = loop._inputs["ros2"]
    for data in (b"", b"\0" * 7, bytes(range(256)), b"\xff" * 4096):
        ros2._receive("/mug", "geometry_msgs/msg/PoseStamped", data)
    assert loop._queue.counts["malformed"] == 4
    assert all(text.startswith("ros2: message") for text in warnings)
