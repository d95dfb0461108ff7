"""Camera frames put together from the pictures, calibrations and transforms of ROS 2."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.errors import RecordingError, requires_extra
from igrip.io.ros2.messages import MAX_LATENCY, TRANSFORMS, add_transforms
from igrip.io.ros2.pictures import (
    Calibration,
    decode_camera_info,
    decode_compressed,
    decode_image,
    rectified,
)
from igrip.io.ros2.storage import RawMessage
from igrip.io.ros2.transforms import Pose, TransformTree
from igrip.rgbd import Array, RgbdFrame

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
FRAME_MESSAGES = (IMAGE, COMPRESSED, CAMERA_INFO, *TRANSFORMS)
APART = 0.02  # s, at most between colour and depth of one frame
WAITING = 3  # colour pictures that wait for their depth
_PICTURE_WORD = re.compile(
    r"image.*|compressed.*|colou?r.*|rgb.*|depth.*|aligned.*|registered|raw|rect.*|points|left|stereo"
)
_ALIGNED = re.compile(r"aligned|registered", re.IGNORECASE)


class _Picture(NamedTuple):
    t: float
    frame: str
    pixels: NDArray[Any]


@dataclass
class _Camera:
    """What is known of one camera so far."""

    colour: str = ""  # its topics
    depth: str = ""
    waiting: deque[_Picture] = field(default_factory=deque)
    depths: deque[_Picture] = field(default_factory=lambda: deque(maxlen=2 * WAITING))
    newest: float = -np.inf  # time of the frame that was yielded last


class RosFrames:
    """Puts together the frames of all cameras; their times count from the first message.

    A camera is named as what is left of its topic without the words for pictures: those of
    ``/camera/color/image_raw`` and ``/camera/aligned_depth_to_color/image_raw`` are one camera's.
    Depth that is not aligned with the colour picture is left out, and remarked.
    """

    def __init__(self) -> None:
        with requires_extra("rosbags", "ros2", "recordings of ROS 2"):
            from rosbags.typesys import Stores, get_typestore
        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._tree = TransformTree()
        self._cameras: dict[str, _Camera] = {}
        self._calibrations: dict[str, Calibration] = {}
        self._begin: float | None = None
        self._left_out: dict[str, str] = {}

    @property
    def colour_topics(self) -> list[str]:
        """The topics whose pictures are colour."""
        return [camera.colour for camera in self._cameras.values() if camera.colour]

    def add(self, raw: RawMessage) -> Iterator[RgbdFrame]:
        """Add a message; yield the frames that it completes.

        Raises
        ------
        RecordingError
            If it is malformed, or a picture has no calibration.
        """
        try:
            message: Any = self._store.deserialize_cdr(raw.data, raw.kind)
        except Exception as error:  # the package trusts its input
            raise RecordingError(f"is no {raw.kind}: {error!r:.200}") from None
        self._begin = raw.t if self._begin is None else self._begin
        if raw.kind in TRANSFORMS:
            add_transforms(self._tree, message)
        elif raw.kind == CAMERA_INFO:
            self._calibrations[raw.topic.rpartition("/")[0]] = decode_camera_info(message)
        elif raw.topic not in self._left_out:
            yield from self._picture(raw, message)

    def rest(self) -> Iterator[RgbdFrame]:
        """Yield the frames that still wait for their depth."""
        for name, camera in self._cameras.items():
            while camera.waiting:
                yield self._frame(name, camera, camera.waiting.popleft())

    def remarks(self) -> list[str]:
        """Return which topics were left out, and why."""
        return [f"left out: {topic}: {why}" for topic, why in self._left_out.items()]

    def _picture(self, raw: RawMessage, message: Any) -> Iterator[RgbdFrame]:
        name = _camera_name(raw.topic)
        camera = self._cameras.setdefault(name, _Camera())
        pixels = decode_image(message) if raw.kind == IMAGE else decode_compressed(message)
        is_depth = pixels.ndim == 2
        topic = camera.depth if is_depth else camera.colour
        if topic not in ("", raw.topic):
            self._left_out[raw.topic] = f"{topic} holds the same camera's picture"
            return
        stamp = float(message.header.stamp.sec) + 1e-9 * float(message.header.stamp.nanosec)
        assert self._begin is not None
        t = (stamp if abs(raw.t - stamp) < MAX_LATENCY else raw.t) - self._begin
        picture = _Picture(t, message.header.frame_id.lstrip("/"), pixels)
        if is_depth:
            camera.depth = raw.topic
            camera.depths.append(picture)
        else:
            camera.colour = raw.topic
            camera.waiting.append(picture)
        while camera.waiting and self._is_due(camera):
            yield self._frame(name, camera, camera.waiting.popleft())

    def _is_due(self, camera: _Camera) -> bool:
        newest = camera.depths[-1].t if camera.depths else -np.inf
        return newest >= camera.waiting[0].t - APART or len(camera.waiting) > WAITING

    def _frame(self, name: str, camera: _Camera, picture: _Picture) -> RgbdFrame:
        calibration = self._calibration(camera.colour)
        if calibration is None:
            raise RecordingError(
                f"no CameraInfo comes before its first picture; record {_namespace(camera.colour)}"
                "/camera_info too"
            )
        intrinsics = calibration.intrinsics
        height, width = picture.pixels.shape[:2]
        if (height, width) != (intrinsics.height, intrinsics.width):
            raise RecordingError(
                f"the picture is {width} × {height}, but its camera_info of {intrinsics.width} × "
                f"{intrinsics.height}"
            )
        if picture.t < camera.newest:
            raise RecordingError("its stamps decrease")
        camera.newest = picture.t
        depth = self._depth_of(camera, picture, calibration)
        colour = picture.pixels
        if "rect" not in camera.colour:
            colour = rectified(colour, calibration)
        return RgbdFrame(picture.t, colour, depth, intrinsics, name, self._pose(picture.frame))

    def _depth_of(
        self, camera: _Camera, picture: _Picture, calibration: Calibration
    ) -> NDArray[np.float32] | None:
        """Return the depth that was taken with a picture, aligned with it; None without any."""
        near = [depth for depth in camera.depths if abs(depth.t - picture.t) <= APART]
        if not near:
            return None
        depth = min(near, key=lambda one: abs(one.t - picture.t))
        own = self._calibration(camera.depth)
        same = own is None or np.allclose(own.intrinsics, calibration.intrinsics, atol=1.0)
        aligned = _ALIGNED.search(camera.depth) or depth.frame == picture.frame
        if depth.pixels.shape != picture.pixels.shape[:2] or not same or not aligned:
            self._left_out[camera.depth] = (
                f"is not aligned with {camera.colour}; record the aligned depth "
                "(aligned_depth_to_color, depth_registered)"
            )
            camera.depths.clear()
            return None
        if "rect" in camera.colour or "rect" in camera.depth:
            return np.asarray(depth.pixels)
        return np.asarray(rectified(depth.pixels, calibration))

    def _calibration(self, topic: str) -> Calibration | None:
        return self._calibrations.get(_namespace(topic))

    def _pose(self, frame: str) -> Array:
        origin, turn = self._tree.in_root(frame, Pose(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])))
        pose = np.eye(4)
        if np.isfinite([*origin, *turn]).all():
            pose[:3, :3], pose[:3, 3] = Rotation.from_quat(turn).as_matrix(), origin
        return pose


def _namespace(topic: str) -> str:
    """Return where the ``camera_info`` of a picture stands: beside it, whatever packs it."""
    parts = topic.split("/")
    if parts[-1].lower().startswith("compressed"):
        parts.pop()
    return "/".join(parts[:-1])


def _camera_name(topic: str) -> str:
    parts = [part for part in topic.split("/") if part]
    return "_".join(p for p in parts if not _PICTURE_WORD.fullmatch(p.lower())) or "camera"
