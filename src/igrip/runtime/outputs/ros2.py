"""Intentions in ROS 2: standard messages, markers for RViz, and QoS that follows from the lease.

Topics of the node ``igrip``: ``/igrip/HAND/intention`` (``std_msgs/String``, the JSON of the wire),
``/igrip/HAND/contact`` (``geometry_msgs/PointStamped``, where the palm will touch) and
``/igrip/markers`` (``visualization_msgs/MarkerArray``). The lifespan is that of a lease: what was
not received by then is not received at all. The deadline is the same: a subscriber that asks for
it is told when intentions stay away.
"""

from __future__ import annotations

from typing import Any

from igrip.commitment_config import CommitmentConfig
from igrip.errors import requires_extra
from igrip.intention import Intention
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS

with requires_extra("ros-rclpy", "ros2-live", "ROS 2"):
    import rclpy
    from geometry_msgs.msg import PointStamped
    from rclpy.duration import Duration
    from rclpy.qos import QoSHistoryPolicy, QoSProfile, QoSReliabilityPolicy
    from std_msgs.msg import String
    from visualization_msgs.msg import Marker, MarkerArray

MAX_HANDS = 32
FRAME = "world"
LEASE: float = CommitmentConfig().lease_duration  # s


def lease_qos() -> Any:
    """Return the quality of service of what a lease is part of."""
    return QoSProfile(
        history=QoSHistoryPolicy.KEEP_LAST, depth=1,
        reliability=QoSReliabilityPolicy.BEST_EFFORT,
        lifespan=Duration(seconds=LEASE), deadline=Duration(seconds=LEASE),
    )  # fmt: skip


@OUTPUTS.register("ros2")
class Ros2Output:
    """A node that publishes, in a context of its own."""

    def __init__(self, options: Options) -> None:
        self._name = options.stream_name
        self._publishers: dict[str, tuple[Any, Any]] = {}
        self._context: Any = None
        self._sent = self._lost = 0

    def start(self, loop: Loop) -> None:
        """Make the node."""
        self._context = rclpy.Context()
        rclpy.init(context=self._context)
        self._node = rclpy.create_node(self._name, context=self._context)
        self._markers = self._node.create_publisher(
            MarkerArray, f"/{self._name}/markers", lease_qos()
        )

    def send(self, envelope: Envelope) -> None:
        """Publish an intention; nobody is waited for."""
        intention = envelope.intention
        publishers = self._of(intention.hand)
        if publishers is None:
            self._lost += 1
            return
        stamp = self._node.get_clock().now().to_msg()
        publishers[0].publish(String(data=envelope.to_json().decode()))
        if intention.contact is not None:
            point = PointStamped()
            point.header.frame_id, point.header.stamp = FRAME, stamp
            point.point.x, point.point.y, point.point.z = map(float, intention.contact)
            publishers[1].publish(point)
        self._markers.publish(markers(intention, envelope.to_dict()["valid_for"], stamp))
        self._sent += 1

    def _of(self, hand: str) -> tuple[Any, Any] | None:
        if hand not in self._publishers:
            if len(self._publishers) >= MAX_HANDS:
                return None
            part = "".join(sign if sign.isascii() and sign.isalnum() else "_" for sign in hand)
            part = f"hand_{part}" if not part[:1].isalpha() else part
            base = f"/{self._name}/{part}"
            self._publishers[hand] = (
                self._node.create_publisher(String, f"{base}/intention", lease_qos()),
                self._node.create_publisher(PointStamped, f"{base}/contact", lease_qos()),
            )
        return self._publishers[hand]

    def counts(self) -> dict[str, int]:
        """Return how many intentions were published, and how many had no topic."""
        return {"sent": self._sent, "lost": self._lost}

    def close(self) -> None:
        """End the node."""
        if self._context is not None and self._context.ok():
            self._node.destroy_node()
            rclpy.shutdown(context=self._context)


def markers(intention: Intention, valid_for: float | None, stamp: Any) -> Any:
    """Return what RViz draws: a ball where the palm will touch, and the words beside it.

    Both vanish after the lifetime of a lease; the ball is green while there is one.
    """
    array = MarkerArray()
    if intention.contact is None:
        return array
    for number, kind in enumerate((Marker.SPHERE, Marker.TEXT_VIEW_FACING)):
        marker = Marker(type=kind, action=Marker.ADD, id=number, ns=intention.hand)
        marker.header.frame_id, marker.header.stamp = FRAME, stamp
        place = marker.pose.position
        place.x, place.y, place.z = map(float, intention.contact)
        marker.pose.orientation.w = 1.0
        marker.scale.x = marker.scale.y = marker.scale.z = 0.04
        marker.color.g, marker.color.a = (1.0, 0.9) if valid_for else (0.5, 0.5)
        marker.color.r = marker.color.b = 0.0 if valid_for else 0.5
        marker.lifetime.nanosec = int(LEASE * 1e9)
        array.markers.append(marker)
    array.markers[1].pose.position.z += 0.06
    array.markers[1].text = f"{intention.target or ''} {intention.grip or ''}".strip()
    return array
