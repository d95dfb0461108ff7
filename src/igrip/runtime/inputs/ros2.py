"""Observations from ROS 2: a ``geometry_msgs/PoseStamped`` for each hand and object, or tf.

``/igrip/hands/HAND/pose`` and ``/igrip/objects/NAME/pose`` are found as they appear; NAME is also
that of the model. A name of ROS must not begin with a digit: an underscore before it is left out
(``/igrip/objects/_006_mustard_bottle/pose``). Transforms on ``/tf`` whose child frame is a hand
(``right_hand``) or a model are taken too, where the package ``tf2_msgs`` is installed. All are in
one fixed frame, the first that comes; others are refused.
"""

from __future__ import annotations

import contextlib
import threading
from typing import Any

from igrip.errors import ObservationError, requires_extra
from igrip.runtime.inputs import INPUTS
from igrip.runtime.inputs._named_poses import NamedPoses
from igrip.runtime.loop import Loop, Sender
from igrip.runtime.options import Options

with requires_extra("ros-rclpy", "ros2-live", "ROS 2"):
    import rclpy
    from geometry_msgs.msg import PoseStamped
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.qos import QoSProfile, QoSReliabilityPolicy

HANDS, OBJECTS, END = "/igrip/hands/", "/igrip/objects/", "/pose"
LOOK_INTERVAL = 0.5  # s between two looks for new topics
MAX_TOPICS = 256


@INPUTS.register("ros2")
class Ros2Input:
    """A node that subscribes, in a thread and a context of its own."""

    single_sender = False

    def __init__(self, options: Options) -> None:
        self._frame, self._poses = options.frame, NamedPoses(options.hands)
        self._world: str | None = None
        self._topics: set[str] = set()
        self._context: Any = None

    def start(self, loop: Loop) -> None:
        """Make the node, and begin to look for topics."""
        self._loop = loop
        self._sender = Sender(name="ros2", frame=self._frame)
        self._context = rclpy.Context()
        rclpy.init(context=self._context)
        self._node = rclpy.create_node("igrip_input", context=self._context)
        self._qos = QoSProfile(depth=8, reliability=QoSReliabilityPolicy.BEST_EFFORT)
        self._node.create_timer(LOOK_INTERVAL, self._look)
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:
            pass
        else:
            self._node.create_subscription(TFMessage, "/tf", self._transforms, 64)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._look()
        self._thread = threading.Thread(target=self._run, name="igrip-ros2", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            self._executor.spin()

    def _look(self) -> None:
        for topic, kinds in self._node.get_topic_names_and_types():
            is_pose = "geometry_msgs/msg/PoseStamped" in kinds and topic.endswith(END)
            if topic in self._topics or len(self._topics) >= MAX_TOPICS or not is_pose:
                continue
            for prefix in (HANDS, OBJECTS):
                if topic.startswith(prefix):
                    self._topics.add(topic)
                    name = topic[len(prefix) : -len(END)].removeprefix("_")
                    self._node.create_subscription(
                        PoseStamped, topic, self._taker(name, prefix == HANDS), self._qos
                    )

    def _taker(self, name: str, is_hand: bool) -> Any:
        def take(message: Any) -> None:
            pose = message.pose
            self._take(name, message.header, pose.position, pose.orientation, is_hand)

        return take

    def _transforms(self, message: Any) -> None:
        for one in message.transforms:
            moved = one.transform
            self._take(one.child_frame_id, one.header, moved.translation, moved.rotation, None)

    def _take(
        self, name: str, header: Any, position: Any, rotation: Any, is_hand: bool | None
    ) -> None:
        """Submit a pose as one message; ``is_hand`` None: as its name says."""
        self._world = self._world or header.frame_id
        if header.frame_id != self._world:
            self._loop.warn(f"ros2: {name!r:.60} is in frame {header.frame_id!r:.60}, not in "
                            f"{self._world!r:.60}: left out")  # fmt: skip
            return
        dated = header.stamp.sec + header.stamp.nanosec * 1e-9
        message: dict[str, Any] = {"hands": {}, "objects": {}}
        message["t"] = dated if dated > 0.0 else self._loop.now() / self._frame.seconds
        place = [position.x, position.y, position.z]
        turn = [rotation.x, rotation.y, rotation.z, rotation.w]
        if is_hand and self._poses.hand(name) is None:
            self._loop.warn(f"ros2: {name!r:.60} is none of the hands that --assisted names")
            return
        self._poses.add(message, name, place, turn)
        if message["hands"] or message["objects"]:
            try:
                self._loop.submit(self._sender.read(message), self._sender)
            except ObservationError as error:
                self._loop.count("malformed")
                self._loop.warn(f"ros2: {error}")

    def close(self) -> None:
        """End the node."""
        if self._context is not None and self._context.ok():
            self._executor.shutdown(timeout_sec=1.0)
            rclpy.shutdown(context=self._context)
            self._thread.join(timeout=2.0)
