"""Intentions on ROS 2, as standard messages, and markers for RViz.

Lifespan and deadline of each topic are the duration of a lease: a message that waited for longer is
not delivered, and a subscription that asks for the deadline is told when the topic falls silent.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Mapping
from typing import Any

from igrip.errors import requires_extra
from igrip.intention import Intention
from igrip.runtime.bounded_queue import BoundedQueue
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.ros_node import RosNode

with requires_extra("ros-visualization-msgs", "ros", "ROS 2"):
    from geometry_msgs.msg import PointStamped
    from rclpy.duration import Duration
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from std_msgs.msg import Float64, String
    from visualization_msgs.msg import Marker, MarkerArray

CLOSE_TIMEOUT = 2.0  # s
MAX_HANDS = 32  # hands with topics of their own, however many ids come and go
GREEN, YELLOW = (0.2, 0.8, 0.3, 0.9), (0.95, 0.75, 0.1, 0.8)


def lease_profile(lease: float, depth: int = 8) -> QoSProfile:
    """Return the quality of service of a topic that holds for a lease [s]."""
    duration = Duration(seconds=lease)
    return QoSProfile(
        depth=depth, reliability=ReliabilityPolicy.RELIABLE, lifespan=duration, deadline=duration
    )


@OUTPUTS.register("ros2")
class Ros2Output:
    """Publishes, in a thread: what waits too long for it is dropped, oldest first."""

    def __init__(self, options: Options) -> None:
        self._ros, self._frame = RosNode.shared(options), options.ros_frame
        self._queue: BoundedQueue[Envelope] = BoundedQueue()
        self._thread = threading.Thread(target=self._run, name="igrip-ros2-out", daemon=True)
        self._publishers: dict[tuple[str, str], Any] = {}
        self._sent, self._open = 0, False

    def start(self, loop: Loop) -> None:
        """Open the node and its topics."""
        self._node, self._open = self._ros.open(loop.session), True
        self._profile = lease_profile(loop.estimator.config.commitment.lease_duration)
        self._intentions = self._node.create_publisher(String, "/igrip/intentions", self._profile)
        self._markers = self._node.create_publisher(MarkerArray, "/igrip/markers", self._profile)
        loop.announce("ros2: /igrip/intentions, /igrip/markers, /igrip/HAND/…")
        self._thread.start()

    def send(self, envelope: Envelope) -> None:
        """Queue an intention."""
        self._queue.put(envelope)

    def _run(self) -> None:
        while not self._queue.finished:
            envelope = self._queue.get()
            if envelope is not None:
                self._publish(envelope)
                self._sent += 1

    def _publish(self, envelope: Envelope) -> None:
        message, intention = envelope.to_dict(), envelope.intention
        stamp = (self._node.get_clock().now() - Duration(seconds=message["age"])).to_msg()
        self._intentions.publish(String(data=envelope.to_json().decode()))
        permitted = self._publisher(intention.hand, "permitted_for", Float64)
        if permitted is not None:
            permitted.publish(Float64(data=message["valid_for"] or 0.0))
        contact = self._publisher(intention.hand, "contact", PointStamped)
        if contact is not None and intention.contact is not None:
            point = PointStamped()
            point.header.frame_id, point.header.stamp = self._frame, stamp
            point.point.x, point.point.y, point.point.z = map(float, intention.contact)
            contact.publish(point)
        self._markers.publish(
            MarkerArray(markers=markers_of(intention, message, self._frame, stamp))
        )

    def _publisher(self, hand: str, name: str, kind: type[Any]) -> Any:
        """Return the publisher of a topic of a hand; None: there are too many hands."""
        hand = re.sub(r"[^A-Za-z0-9_]", "_", hand)
        hand = f"_{hand}" if hand[:1].isdigit() else hand
        key = hand, name
        if key not in self._publishers:
            if len(self._publishers) >= 2 * MAX_HANDS:
                return None
            topic = f"/igrip/{hand}/{name}"
            self._publishers[key] = self._node.create_publisher(kind, topic, self._profile)
        return self._publishers[key]

    def counts(self) -> dict[str, int]:
        """Return how many intentions were published, and how many lost."""
        return {"sent": self._sent, "lost": self._queue.counts["dropped"]}

    def close(self) -> None:
        """Publish what waits, and close the node."""
        self._queue.close()
        if self._thread.is_alive():
            self._thread.join(CLOSE_TIMEOUT)
        if self._open:
            self._open = False
            self._ros.close()


def markers_of(
    intention: Intention, message: Mapping[str, Any], frame: str, stamp: Any
) -> list[Marker]:
    """Return a sphere at the contact and a text above it; both vanish with the lease.

    Green where a device may act, yellow where the target is only expected. Without a contact, the
    hand's markers are taken away.
    """
    permitted, markers = message["valid_for"], []
    for number, kind in enumerate((Marker.SPHERE, Marker.TEXT_VIEW_FACING)):
        marker = Marker()
        marker.header.frame_id, marker.header.stamp = frame, stamp
        marker.ns, marker.id, marker.type = intention.hand, number, kind
        marker.action = Marker.DELETE if intention.contact is None else Marker.ADD
        if intention.contact is not None:
            at = marker.pose.position
            at.x, at.y, at.z = map(float, intention.contact)
            at.z += 0.06 * number
            marker.pose.orientation.w = 1.0
            marker.scale.x = marker.scale.y = marker.scale.z = 0.03
            colour = GREEN if permitted else YELLOW
            marker.color.r, marker.color.g, marker.color.b, marker.color.a = colour
            marker.text = _caption(intention) if number else ""
            marker.lifetime = Duration(seconds=permitted or 0.15).to_msg()
        markers.append(marker)
    return markers


def _caption(intention: Intention) -> str:
    sure = "" if intention.confidence is None else f" {intention.confidence:.0%}"
    return f"{intention.target or 'no target'}, {intention.grip or 'no grip'}{sure}"
