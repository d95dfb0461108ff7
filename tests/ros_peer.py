"""Another node of ROS 2, in a process of its own.

``listen SECONDS``: prints a line of JSON for each message of igrip's topics, and for each time
that none came for so long. ``speak MODEL``: publishes a hand and an object. Both until their
standard input ends.
"""

from __future__ import annotations

import json
import sys
import threading
import time
import warnings

warnings.simplefilter("ignore")

import rclpy  # noqa: E402
from geometry_msgs.msg import PointStamped, PoseStamped, TransformStamped  # noqa: E402
from rclpy.duration import Duration  # noqa: E402
from rclpy.event_handler import SubscriptionEventCallbacks  # noqa: E402
from rclpy.qos import QoSProfile  # noqa: E402
from std_msgs.msg import Float64, String  # noqa: E402
from visualization_msgs.msg import MarkerArray  # noqa: E402


def say(**what):
    print(json.dumps(what), flush=True)


def listen(node):
    profile = QoSProfile(depth=20, deadline=Duration(seconds=float(sys.argv[2])))
    events = SubscriptionEventCallbacks(deadline=lambda event: say(missed=event.total_count))
    node.create_subscription(
        String, "/igrip/intentions", lambda m: say(intention=json.loads(m.data)), profile,
        event_callbacks=events,
    )  # fmt: skip
    node.create_subscription(
        Float64, "/igrip/right/permitted_for", lambda m: say(permitted_for=m.data), 20
    )
    node.create_subscription(
        PointStamped, "/igrip/right/contact",
        lambda m: say(contact=[m.header.frame_id, m.point.x, m.point.y, m.point.z]), 20,
    )  # fmt: skip
    node.create_subscription(
        MarkerArray, "/igrip/markers",
        lambda m: say(markers=[[k.ns, k.id, k.action, k.lifetime.nanosec] for k in m.markers]), 20,
    )  # fmt: skip


def speak(node):
    hand = node.create_publisher(PoseStamped, "/right_hand/pose", 5)
    mug = node.create_publisher(TransformStamped, "/table/transforms", 5)
    step = 0

    def publish():
        nonlocal step
        step += 1
        now = node.get_clock().now().to_msg()
        pose = PoseStamped()
        pose.header.stamp, pose.header.frame_id = now, "world"
        pose.pose.position.x, pose.pose.position.y = 0.002 * step, 0.001 * (step % 3)
        pose.pose.orientation.w = 1.0
        hand.publish(pose)
        one = TransformStamped()
        one.header.stamp, one.header.frame_id, one.child_frame_id = now, "world", sys.argv[2]
        one.transform.translation.x, one.transform.rotation.w = 0.3, 1.0
        mug.publish(one)

    node.create_timer(1 / 30, publish)


def main():
    rclpy.init()
    node = rclpy.create_node(f"peer_{sys.argv[1]}")
    {"listen": listen, "speak": speak}[sys.argv[1]](node)
    ended = threading.Event()

    def wait():
        sys.stdin.read()
        ended.set()

    threading.Thread(target=wait, daemon=True).start()
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    say(ready=time.time())
    while not ended.is_set():
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
