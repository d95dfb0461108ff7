"""Intentions on ROS 2, received by a node in another process."""

from __future__ import annotations

import pytest

from igrip.runtime.options import Options
from ros import domain, needs_ros, peer  # noqa: F401
from runtime_fakes import until
from wire import PERMITTED, STORY, FakeLoop, envelopes

pytestmark = needs_ros
LONG = 120.0  # s that a lease holds where nothing may be lost on a slow machine
ADD, DELETE = 0, 2  # visualization_msgs/msg/Marker


def started(lease):
    from igrip.runtime.outputs.ros2 import Ros2Output

    one = Ros2Output(Options(ros_frame="lab"))
    one.start(FakeLoop(lease))
    return one


@pytest.fixture
def output(domain):  # noqa: F811
    one = started(LONG)
    yield one
    one.close()
    one.close()


def send(output):
    """Send the story to a peer that is there, which takes a while."""
    topics = (output._intentions, output._markers)
    until(lambda: all(topic.get_subscription_count() for topic in topics))
    for envelope in envelopes():
        output.send(envelope)


def test_another_node_gets_intentions_with_what_is_left_of_their_leases(output):
    with peer("listen", str(LONG)) as hear:
        send(output)
        messages = [hear("intention") for _ in STORY]
        assert [message["status"] for message in messages] == [one.status for one in STORY]
        left = [message["valid_for"] or 0.0 for message in messages]
        assert left == pytest.approx(PERMITTED)
        until(lambda: output.counts() == {"sent": len(STORY), "lost": 0})


def test_the_topics_of_a_hand(output):
    with peer("listen", str(LONG)) as hear:
        send(output)
        until(lambda: ("right", "permitted_for") in output._publishers)
        until(lambda: all(one.get_subscription_count() for one in output._publishers.values()))
        for envelope in envelopes():
            output.send(envelope)
        assert hear("contact") == ["lab", *STORY[1].contact]
        hand, number, action, _ = hear("markers")[0]
        assert (hand, number) == ("right", 0)
        assert action in (ADD, DELETE)


def test_markers_vanish_with_the_lease_and_go_when_there_is_no_contact(domain):  # noqa: F811
    from builtin_interfaces.msg import Time

    from igrip.runtime.outputs.ros2 import markers_of

    for envelope, permitted in zip(envelopes(), PERMITTED, strict=True):
        message = envelope.to_dict()
        sphere, text = markers_of(envelope.intention, message, "lab", Time())
        assert [sphere.id, text.id] == [0, 1]
        if not permitted:
            assert sphere.action == text.action == DELETE
            continue
        assert sphere.action == ADD
        assert sphere.lifetime.nanosec == pytest.approx(permitted * 1e9, rel=1e-3)
        assert sphere.color.g > sphere.color.r
        assert text.text == "mug, palmar 88%"


def test_a_subscription_is_told_when_the_topic_falls_silent(domain):  # noqa: F811
    output = started(lease=0.15)
    with peer("listen", "0.5") as hear:
        until(output._intentions.get_subscription_count)

        def heard():  # a slow machine may be later than the lifespan: send until something is heard
            for envelope in envelopes():
                output.send(envelope)
            return hear("intention", wait=0.1)

        until(heard)
        assert hear("missed") >= 1  # nothing comes any more
    output.close()


def test_lifespan_and_deadline_are_those_of_the_lease(domain):  # noqa: F811
    output = started(lease=0.25)
    for profile in (output._intentions.qos_profile, output._markers.qos_profile):
        assert profile.lifespan.nanoseconds == 250_000_000
        assert profile.deadline.nanoseconds == 250_000_000
    output.close()
