"""Observations from ROS 2: stamped poses and transforms, found by the types of their topics.

A topic that is named as a hand (``/right_hand/pose``) is a hand, every other one an object whose
model is named as it is: the rules of bags (:mod:`igrip.io.ros2.messages`).
"""

from __future__ import annotations

import re
import threading
import time
from typing import Any

from igrip.errors import ObservationError, requires_extra
from igrip.io.hand_ids import match_hand
from igrip.io.ros2.messages import READABLE, RosMessages
from igrip.runtime.inputs import INPUTS
from igrip.runtime.loop import Loop, Sender
from igrip.runtime.options import Options
from igrip.runtime.ros_node import RosNode, message_type

with requires_extra("ros-rclpy", "ros", "ROS 2"):
    from rclpy.qos import QoSProfile, ReliabilityPolicy

LOOK = 0.5  # s between two looks for new topics
PATIENCE = 5.0  # s without any topic after which those that there are are named
MAX_TOPICS = 256
MAX_BYTES = 1 << 20  # of a message
OWN = re.compile(r"^/igrip/")  # what an output publishes


@INPUTS.register("ros2")
class Ros2Input:
    """Subscribes to every topic of a readable type; topics that come later are found.

    A subscription is best-effort, which receives from reliable publishers too.
    """

    single_sender = False

    def __init__(self, options: Options) -> None:
        self._ros, self._hands = RosNode.shared(options), options.hands
        self._messages = RosMessages()
        self._sender = Sender(name="ros2", frame=options.frame)
        self._topics: dict[str, Any] = {}
        self._stop, self._open = threading.Event(), False

    def start(self, loop: Loop) -> None:
        """Begin to look for topics, in a thread."""
        self._loop = loop
        self._node, self._open = self._ros.open(loop.session), True
        self._thread = threading.Thread(target=self._look, name="igrip-ros2-in", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Receive no more."""
        self._stop.set()
        if self._open:
            self._open = False
            self._thread.join(timeout=5.0)
            self._ros.close()

    def _look(self) -> None:
        begin = time.monotonic()
        while not self._stop.is_set():
            for topic, kinds in self._node.get_topic_names_and_types():
                if topic not in self._topics and not OWN.match(topic):
                    self._subscribe(topic, kinds)
            if not self._topics and time.monotonic() - begin > PATIENCE:
                self._loop.warn(f"ros2: no topic yet of {', '.join(READABLE)}")
            self._stop.wait(LOOK)

    def _subscribe(self, topic: str, kinds: list[str]) -> None:
        kind = next((kind for kind in kinds if kind in READABLE), None)
        if kind is None or len(self._topics) >= MAX_TOPICS:
            return
        found = message_type(kind)
        if found is None:
            self._loop.warn(f"ros2: {topic} needs the package of {kind}, which is not installed")
            self._topics[topic] = None
            return
        profile = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._topics[topic] = self._node.create_subscription(
            found, topic, lambda data: self._receive(topic, kind, data), profile, raw=True
        )
        self._loop.announce(f"ros2: {topic} ({kind})")

    def _receive(self, topic: str, kind: str, data: bytes) -> None:
        try:
            if len(data) > MAX_BYTES:
                raise ObservationError("message", f"of {topic} is larger than {MAX_BYTES} bytes")
            message = self._messages.read(topic, kind, time.time(), bytes(data))
            message["hands"] = {
                match_hand(id, self._hands) or id: hand for id, hand in message["hands"].items()
            }
            self._loop.submit(self._sender.read(message), self._sender)
        except ObservationError as error:
            self._loop.count("malformed")
            self._loop.warn(f"ros2: {error}")
