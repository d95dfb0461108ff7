"""UDP, OSC, MQTT and ROS 2, received by other software than ours."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import threading
import time

import pytest
from pythonosc.osc_packet import OscPacket

from igrip.errors import IgripError
from igrip.intention import Commitment, Intention
from igrip.runtime.envelope import Sequencer
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from runtime_fakes import PATIENCE, Clock, until

CLOCK = Clock(5.0)


def envelope(hand="right", lease=True):
    given = Commitment(target="mug", grip="palmar", since=4.9, valid_until=5.12)
    intention = Intention(
        t=5.0, hand=hand, status="reaching", target="mug", grip="palmar", confidence=0.75,
        contact=(0.1, 0.2, 0.3), commitment=given if lease else None,
    )  # fmt: skip
    return Sequencer(CLOCK).wrap(intention, 5.0)


class Loop:
    warned: list[str] = []  # noqa: RUF012

    def warn(self, text):
        self.warned.append(text)


@pytest.fixture
def receiver():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        one.settimeout(PATIENCE)
        yield one, f"127.0.0.1:{one.getsockname()[1]}"


def test_udp(receiver):
    socket, address = receiver
    output = OUTPUTS.get("udp")(Options(udp_to=address))
    output.start(Loop())
    output.send(envelope())
    message = json.loads(socket.recv(65536))
    assert message["commitment"]["target"] == "mug"
    assert message["valid_for"] == pytest.approx(0.12)
    assert output.counts() == {"sent": 1}
    output.close()
    output.send(envelope())  # late: lost, and no error
    assert output.counts()["lost"] == 1


def test_osc(receiver):
    socket, address = receiver
    output = OUTPUTS.get("osc")(Options(osc_to=address))
    output.start(Loop())
    output.send(envelope("left hand/1"))
    packet = OscPacket(socket.recv(65536))
    values = {one.message.address: one.message.params[0] for one in packet.messages}
    assert values["/igrip/left_hand_1/target"] == "mug"
    assert values["/igrip/left_hand_1/lease"] == pytest.approx(0.12)
    assert values["/igrip/left_hand_1/confidence"] == 0.75
    assert values["/igrip/left_hand_1/time_to_contact"] == -1.0
    output.close()


@pytest.mark.parametrize("address", ["", "host", "127.0.0.1:x", "127.0.0.1:0", "127.0.0.1:99999"])
def test_what_is_no_address_is_refused(address):
    with pytest.raises(IgripError, match="HOST:PORT"):
        OUTPUTS.get("udp")(Options(udp_to=address))


BROKER = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")


def listens(port):
    with socket.socket() as trial:
        return not trial.connect_ex(("127.0.0.1", port))


@pytest.fixture
def broker(tmp_path):
    if BROKER is None:
        pytest.skip("no mosquitto (Debian's package)")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    file = tmp_path / "broker.conf"
    file.write_text(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
    process = subprocess.Popen([BROKER, "-c", file], stderr=subprocess.DEVNULL)
    try:
        until(lambda: listens(port))
        yield f"127.0.0.1:{port}"
    finally:
        process.kill()
        process.wait()


@pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)
def test_mqtt(broker):
    mqtt = pytest.importorskip("paho.mqtt.client")
    from paho.mqtt.enums import CallbackAPIVersion

    heard, subscribed = [], threading.Event()
    client = mqtt.Client(CallbackAPIVersion.VERSION2)
    client.on_message = lambda client, data, message: heard.append(message)
    client.on_subscribe = lambda *arguments: subscribed.set()
    host, _, port = broker.partition(":")
    client.connect(host, int(port))
    client.loop_start()
    client.subscribe("igrip/#")
    assert subscribed.wait(PATIENCE)
    output = OUTPUTS.get("mqtt")(Options(mqtt_broker=broker))
    output.start(Loop())

    def heard_of(topic):
        output.send(envelope("right/2"))
        time.sleep(0.02)
        return [one for one in heard if one.topic == topic]

    until(lambda: heard_of("igrip/right_2/intention"))
    message = heard_of("igrip/right_2/intention")[0]
    assert json.loads(message.payload)["commitment"]["target"] == "mug"
    assert not message.retain
    assert output.counts()["sent"] > 0
    output.close()
    until(lambda: [one for one in heard if one.payload == b"offline"])
    client.disconnect()
    client.loop_stop()


def test_no_broker():
    pytest.importorskip("paho.mqtt.client")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        output = OUTPUTS.get("mqtt")(Options(mqtt_broker=f"127.0.0.1:{port}"))
        with pytest.raises(IgripError, match="no MQTT broker"):
            output.start(Loop())


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of the packages of ROS 2
def test_ros2_both_ways(shapes):
    """A node of ROS 2 hears intentions, and its poses become observations."""
    rclpy = pytest.importorskip("rclpy")
    from geometry_msgs.msg import PointStamped, PoseStamped
    from std_msgs.msg import String
    from visualization_msgs.msg import MarkerArray

    import igrip
    from igrip.runtime.clock_sync import ArrivalClock
    from igrip.runtime.inputs import INPUTS
    from igrip.runtime.loop import Loop as RealLoop
    from igrip.runtime.outputs.ros2 import LEASE, lease_qos

    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("somebody", context=context)
    executor = rclpy.executors.SingleThreadedExecutor(context=context)
    executor.add_node(node)
    texts, points, drawn = [], [], []
    node.create_subscription(String, "/igrip/right/intention", texts.append, lease_qos())
    node.create_subscription(PointStamped, "/igrip/right/contact", points.append, lease_qos())
    node.create_subscription(MarkerArray, "/igrip/markers", drawn.append, lease_qos())
    output = OUTPUTS.get("ros2")(Options())
    output.start(Loop())

    def hear():
        output.send(envelope())
        executor.spin_once(timeout_sec=0.02)
        return texts and points and drawn

    until(hear)
    assert json.loads(texts[0].data)["commitment"]["grip"] == "palmar"
    assert (points[0].point.x, points[0].header.frame_id) == (0.1, "world")
    assert drawn[0].markers[1].text == "mug palmar"
    assert drawn[0].markers[0].lifetime.nanosec == round(LEASE * 1e9)
    (info,) = node.get_publishers_info_by_topic("/igrip/right/intention")
    assert info.qos_profile.lifespan.nanoseconds == round(LEASE * 1e9)
    assert info.qos_profile.deadline.nanoseconds == round(LEASE * 1e9)
    output.close()

    hands = node.create_publisher(PoseStamped, "/igrip/hands/right/pose", 10)
    things = node.create_publisher(PoseStamped, "/igrip/objects/_006_mustard_bottle/pose", 10)
    loop = RealLoop(
        igrip.Estimator(shapes), ArrivalClock(), {"ros2": INPUTS.get("ros2")(Options())}, {}
    )
    models, submit = set(), loop.submit

    def note(message, sender):
        models.update(pose.model for pose in message.objects.values())
        submit(message, sender)

    loop.submit = note

    def take():
        pose = PoseStamped()
        pose.header.frame_id = "world"
        pose.pose.position.x, pose.pose.orientation.w = 0.25, 1.0
        hands.publish(pose)
        things.publish(pose)
        loop.step(0.02)
        return loop.estimator.hands and models

    with loop:
        until(take)
        assert list(loop.estimator.hands) == ["right"]
        assert models == {"006_mustard_bottle"}
    node.destroy_node()
    rclpy.shutdown(context=context)
