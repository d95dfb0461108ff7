"""Intentions on ROS 2, received by a node in another process."""

from __future__ import annotations

import pytest

from igrip.runtime.options import Options
from ros import domain, needs_ros, peer  # noqa: F401
from runtime_fakes import until
from wire import PERMITTED, STORY, FakeLoop, envelopes

pytestmark = needs_ros
ADD, DELETE = 0, 2  # visualization_msgs/msg/Marker


@pytest.fixture
def output(domain):  # noqa: F811
    from igrip.runtime.outputs.ros2 import Ros2Output

    one = Ros2Output(Options(ros_frame="lab"))
    one.start(FakeLoop())
    yield one
    one.close()
    one.close()


def send_until_heard(output, hear):
    """Send the story again and again until the peer, whose discovery takes time, has heard it."""
    with_subscriber = output._intentions.get_subscription_count
    until(lambda: with_subscriber() and output._markers.get_subscription_count())
    for envelope in envelopes():
        output.send(envelope)


def test_another_node_gets_intention_lease_contact_and_markers(output):
    with peer("listen") as hear:
        send_until_heard(output, hear)
        messages = [hear("intention") for _ in STORY]
        assert [message["status"] for message in messages] == [one.status for one in STORY]
        left = [message["valid_for"] or 0.0 for message in messages]
        assert left == pytest.approx(PERMITTED)
        for envelope in envelopes():  # the topics of a hand are there since its first intention
            output.send(envelope)
        until(lambda: output.counts() == {"sent": 2 * len(STORY), "lost": 0})


def test_the_topics_of_a_hand(output):
    with peer("listen") as hear:
        send_until_heard(output, hear)
        until(lambda: ("right", "permitted_for") in output._publishers)
        until(lambda: all(one.get_subscription_count() for one in output._publishers.values()))
        for envelope in envelopes():
            output.send(envelope)
        assert hear("contact") == ["lab", *STORY[1].contact]


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


def test_a_subscription_is_told_when_the_topic_falls_silent(output):
    with peer("listen") as hear:
        send_until_heard(output, hear)
        hear("intention")
        assert hear("missed") >= 1  # nothing comes any more


def test_lifespan_and_deadline_are_those_of_the_lease(output):
    lease = FakeLoop().estimator.config.commitment.lease_duration
    for profile in (output._intentions.qos_profile, output._markers.qos_profile):
        assert profile.lifespan.nanoseconds == round(lease * 1e9)
        assert profile.deadline.nanoseconds == round(lease * 1e9)
