"""Messages of ROS 2 as observations: transforms (tf) and stamped poses."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from igrip.errors import ObservationError, requires_extra
from igrip.io.hand_ids import is_hand, side_of
from igrip.io.ros2.transforms import Pose, TransformTree

TRANSFORMS = ("tf2_msgs/msg/TFMessage", "geometry_msgs/msg/TransformStamped")
POSES = (
    "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped",
    "nav_msgs/msg/Odometry",
)  # fmt: skip
READABLE = (*TRANSFORMS, *POSES)
_ZSTD = b"\x28\xb5\x2f\xfd"  # the first bytes of what zstd compressed
MAX_LATENCY = 5.0  # s from a stamp to its arrival; one that is older is of another clock
PICTURES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage",
            "sensor_msgs/msg/PointCloud2")  # fmt: skip
_NO_THINGS = re.compile(r"camera|optical|sensor|imu|^map$|^odom|^base|^world", re.IGNORECASE)
_NO_NAMES = {"pose", "poses", "tf", "odom", "tracker", "vrpn", "mocap", "data", "world"}


class RosMessages:
    """Turns messages of ROS 2 into messages of igrip, which count time from the first.

    A frame or topic that is named as a hand (``right_hand``) is a hand; every other one that no
    other frame is given in is an object, whose model is named as it is; frames of cameras, maps and
    robots are neither. A pose is that of the root of the tree of transforms.

    Raises
    ------
    MissingExtraError
        If the package rosbags is not installed.
    """

    def __init__(self) -> None:
        with requires_extra("rosbags", "ros2", "recordings of ROS 2"):
            from rosbags.typesys import Stores, get_typestore
        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._tree = TransformTree()
        self._begin: float | None = None

    def read(self, topic: str, kind: str, arrived: float, data: bytes) -> dict[str, Any]:
        """Return a message of igrip, with its parts as they are.

        Parameters
        ----------
        topic, kind : str
            Of the message.
        arrived : float
            When it was recorded [s].
        data : bytes
            As CDR.

        Raises
        ------
        ObservationError
            If it cannot be read.
        """
        try:
            message: Any = self._store.deserialize_cdr(data, kind)
        except Exception as error:  # the package trusts its input
            if data.startswith(_ZSTD):
                raise ObservationError(
                    "message",
                    "is compressed by itself: open the folder of the bag, with metadata.yaml",
                ) from None
            raise ObservationError("message", f"of {topic} is no {kind}: {error!r:.200}") from None
        if self._begin is None:
            self._begin = arrived
        read: dict[str, Any] = {"t": arrived - self._begin, "hands": {}, "objects": {}}
        for name, stamp, pose in self._poses(topic, kind, message):
            entity: dict[str, Any] = {"position": pose.position.tolist()}
            if 0.0 <= arrived - stamp < MAX_LATENCY and stamp >= self._begin:
                entity["t"] = stamp - self._begin
            if is_hand(name):
                read["hands"][side_of(name) or name] = entity
            else:
                entity |= {"orientation": pose.quaternion.tolist(), "model": name}
                read["objects"][name] = entity
        return read

    def _poses(self, topic: str, kind: str, message: Any) -> Iterator[tuple[str, float, Pose]]:
        """Yield name, stamp and pose in the root of everything in a message."""
        if kind in TRANSFORMS:
            for one in add_transforms(self._tree, message):
                parent, child = one.header.frame_id.lstrip("/"), one.child_frame_id.lstrip("/")
                if not self._tree.is_parent(child) and not _NO_THINGS.search(child):
                    shift, turn = one.transform.translation, one.transform.rotation
                    pose = self._tree.in_root(parent, _pose(shift, turn))
                    yield child, _seconds(one.header.stamp), pose
            return
        pose = message.pose if hasattr(message.pose, "position") else message.pose.pose
        frame = message.header.frame_id.lstrip("/")
        in_root = self._tree.in_root(frame, _pose(pose.position, pose.orientation))
        yield _name_of(topic), _seconds(message.header.stamp), in_root


def add_transforms(tree: TransformTree, message: Any) -> Sequence[Any]:
    """Add the transforms of a message of the types :data:`TRANSFORMS` to a tree; return them."""
    transforms: Sequence[Any] | None = getattr(message, "transforms", None)
    transforms = [message] if transforms is None else transforms
    for one in transforms:
        parent, child = one.header.frame_id.lstrip("/"), one.child_frame_id.lstrip("/")
        tree.set(child, parent, _pose(one.transform.translation, one.transform.rotation))
    return transforms


def describe_topics(topics: Counter[tuple[str, str]]) -> str:
    """Return what is in a file of topics and types, and what could be read of it."""
    listed = [f"{topic} ({kind}): {count} messages" for (topic, kind), count in topics.items()]
    more = f", and {len(listed) - 12} more topics" if len(listed) > 12 else ""
    kinds = ", ".join(READABLE)
    return (
        f"holds {', '.join(listed[:12]) or 'no messages'}{more}. What can be read: /observations "
        f"of igrip; of ROS 2 {kinds}{_no_pictures(topics)}"
    )


def left_out(topics: Counter[tuple[str, str]]) -> list[str]:
    """Return which topics are not read, as remarks; a reader calls it after the last message."""
    names = sorted(topic for topic, kind in topics if kind not in READABLE)
    if not names:
        return []
    more = f", and {len(names) - 12} more" if len(names) > 12 else ""
    return [f"left out: {', '.join(names[:12])}{more}{_no_pictures(topics)}"]


def _no_pictures(topics: Counter[tuple[str, str]]) -> str:
    if not any(kind in PICTURES for _, kind in topics):
        return ""
    return (
        ". Pictures are read as those of a camera, and hands and objects are found in them: igrip "
        "live --camera replay:FOLDER"
    )


def _pose(position: Any, quaternion: Any) -> Pose:
    return Pose(
        np.array([position.x, position.y, position.z]),
        np.array([quaternion.x, quaternion.y, quaternion.z, quaternion.w]),
    )


def _seconds(stamp: Any) -> float:
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def _name_of(topic: str) -> str:
    """Return what a topic of poses is named after: ``mug`` of ``/vrpn/mug/pose``."""
    parts = [part for part in topic.split("/") if part]
    named = [part for part in parts if re.sub(r"\d+$", "", part).lower() not in _NO_NAMES]
    return (named or parts or ["pose"])[-1]
