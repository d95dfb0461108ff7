"""Camera frames as the messages that Foxglove and other MCAP readers know, and back.

Colour and depth are ``foxglove.CompressedImage``: JPEG (or PNG), and PNG of 16 bits. Both share one
``foxglove.CameraCalibration``; a ``foxglove.FrameTransform`` places the camera in the world.
``foxglove.ImageAnnotations`` draw the detected hands.
"""

from __future__ import annotations

import importlib
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.errors import RecordingError, requires_extra
from igrip.io.mcap.messages import Detections
from igrip.io.packed_pictures import unpack_picture
from igrip.rgbd import Array, Intrinsics, RgbdFrame

WORLD = "world"
TYPES = {  # of the messages of each kind of topic
    "colour": "CompressedImage", "depth": "CompressedImage", "calibration": "CameraCalibration",
    "tf": "FrameTransform", "annotations": "ImageAnnotations",
}  # fmt: skip
GREEN = {"r": 0.1, "g": 0.9, "b": 0.4, "a": 1.0}
DEPTH_UNIT = 1e-4  # m; exact for cameras that count in mm or in 0.1 mm, up to 6.5 m
JPEG_QUALITY = 90


class Schema(NamedTuple):
    """A type of protobuf message, with the description of it that goes into the file."""

    name: str
    description: bytes
    message: Any


@cache
def schema(name: str) -> Schema:
    """Return one of Foxglove's message types, for example ``CompressedImage``.

    Raises
    ------
    MissingExtraError
        If the package is not installed.
    """
    with requires_extra("foxglove-schemas-protobuf", "mcap", "MCAP recordings"):
        from google.protobuf.descriptor_pb2 import FileDescriptorSet

        module = importlib.import_module(f"foxglove_schemas_protobuf.{name}_pb2")
    message = getattr(module, name)
    files: dict[str, Any] = {}

    def collect(file: Any) -> None:
        """Add a file after those it depends on."""
        for other in file.dependencies:
            if other.name not in files:
                collect(other)
        files[file.name] = file

    collect(message.DESCRIPTOR.file)
    descriptors = FileDescriptorSet()
    for file in files.values():
        file.CopyToProto(descriptors.file.add())
    return Schema(message.DESCRIPTOR.full_name, descriptors.SerializeToString(), message)


def _cv2() -> Any:
    with requires_extra("opencv-python-headless", "mcap", "pictures in MCAP"):
        import cv2
    return cv2


def nanoseconds(t: float) -> int:
    """Return a time in whole nanoseconds, as MCAP keeps it: up to 570 years."""
    return round(min(max(t, 0.0), 1.8e10) * 1e9)


def _encode(kind: str, t: float, **fields: Any) -> bytes:
    message = schema(kind).message(timestamp=_timestamp(t), **fields)
    return bytes(message.SerializeToString())


def _timestamp(t: float) -> dict[str, int]:
    ns = min(nanoseconds(t), 253402300799 * 10**9)  # the last moment protobuf knows
    return {"seconds": ns // 10**9, "nanos": ns % 10**9}


def encode_colour(frame: RgbdFrame, lossless: bool = False, quality: int = JPEG_QUALITY) -> bytes:
    """Return the colour picture of a frame as a message."""
    cv2 = _cv2()
    bgr = cv2.cvtColor(frame.colour, cv2.COLOR_RGB2BGR)
    options = [cv2.IMWRITE_PNG_COMPRESSION, 1] if lossless else [cv2.IMWRITE_JPEG_QUALITY, quality]
    _, data = cv2.imencode(".png" if lossless else ".jpg", bgr, options)
    return _encode_picture(frame, data, "png" if lossless else "jpeg")


def encode_depth(frame: RgbdFrame, unit: float = DEPTH_UNIT) -> bytes:
    """Return the depth of a frame as a message; what does not fit into 16 bits becomes 0."""
    assert frame.depth is not None
    cv2 = _cv2()
    counts = frame.depth * np.float32(1.0 / unit)
    counts += np.float32(0.5)
    counts[~((counts >= 0) & (counts < 65536))] = 0  # NaN too
    options = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_SUB]
    _, data = cv2.imencode(".png", counts.astype(np.uint16), options)
    return _encode_picture(frame, data, "png")


def _encode_picture(frame: RgbdFrame, data: NDArray[np.uint8], form: str) -> bytes:
    return _encode(
        "CompressedImage", frame.t, frame_id=frame.camera, data=data.tobytes(), format=form
    )


def encode_calibration(frame: RgbdFrame) -> bytes:
    """Return the intrinsics of a frame as a message."""
    camera = frame.intrinsics
    k = camera.matrix
    return _encode(
        "CameraCalibration", frame.t, frame_id=frame.camera, width=camera.width,
        height=camera.height, distortion_model="plumb_bob", D=[0.0] * 5, K=k.ravel().tolist(),
        R=np.eye(3).ravel().tolist(), P=np.column_stack([k, np.zeros(3)]).ravel().tolist(),
    )  # fmt: skip


def encode_transform(frame: RgbdFrame) -> bytes:
    """Return the pose of a frame's camera in the world as a message."""
    pose = frame.world_from_camera
    quaternion = Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()
    return _encode(
        "FrameTransform", frame.t, parent_frame_id=WORLD, child_frame_id=frame.camera,
        translation=dict(zip("xyz", pose[:3, 3].tolist(), strict=True)),
        rotation=dict(zip("xyzw", quaternion, strict=True)),
    )  # fmt: skip


def encode_annotations(detections: Detections) -> bytes:
    """Return the detected hands as points and labels that a viewer draws over the picture."""
    points, texts = [], []
    time = _timestamp(detections.t)
    for hand in detections.hands:
        landmarks = [{"x": u, "y": v} for u, v in hand.landmarks]
        points.append({
            "timestamp": time, "type": "POINTS", "thickness": 4.0, "points": landmarks,
            "outline_color": GREEN,
        })  # fmt: skip
        if landmarks:
            text = f"{hand.label or 'hand'} {hand.score:.0%}"
            texts.append({
                "timestamp": time, "position": landmarks[0], "text": text, "font_size": 16.0,
                "text_color": GREEN,
            })  # fmt: skip
    return _encode("ImageAnnotations", detections.t, points=points, texts=texts)


def decode_picture(data: bytes) -> NDArray[Any]:
    """Return the picture of a message: (h, w, 3) uint8 red, green, blue, or (h, w) uint16.

    Raises
    ------
    RecordingError
        If the message holds no such picture.
    """
    return unpack_picture(packed_picture(data))


def packed_picture(data: bytes) -> bytes:
    """Return the picture of a message as it is stored, JPEG or PNG.

    Raises
    ------
    RecordingError
        If the message is no picture.
    """
    packed: bytes = _parse("CompressedImage", data).data
    return packed


def decode_calibration(data: bytes) -> Intrinsics:
    """Return the intrinsics of a message.

    Raises
    ------
    RecordingError
        If it holds none, or the pictures are distorted: frames are rectified.
    """
    message = _parse("CameraCalibration", data)
    k = list(message.K)
    if len(k) != 9 or not np.isfinite(k).all() or min(k[0], k[4]) <= 0.0:
        raise RecordingError("K: must be a camera matrix of 9 numbers")
    if any(message.D):
        raise RecordingError("D: the pictures are distorted; rectify them first")
    if message.width < 1 or message.height < 1:
        raise RecordingError("width, height: must be at least 1")
    return Intrinsics(message.width, message.height, k[0], k[4], k[2], k[5])


def decode_transform(data: bytes) -> tuple[str, Array]:
    """Return the name of a camera and its world_from_camera, shape (4, 4)."""
    message = _parse("FrameTransform", data)
    position, rotation = message.translation, message.rotation
    pose = np.eye(4)
    pose[:3, 3] = position.x, position.y, position.z
    quaternion = np.array([rotation.x, rotation.y, rotation.z, rotation.w])
    if not np.isfinite(pose).all() or not 0.5 < np.linalg.norm(quaternion) < 2.0:
        raise RecordingError("rotation: must be a unit quaternion, and the translation finite")
    pose[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
    return str(message.child_frame_id), pose


def _parse(kind: str, data: bytes) -> Any:
    from google.protobuf.message import DecodeError

    try:
        return schema(kind).message.FromString(data)
    except DecodeError as error:
        raise RecordingError(f"is no {kind}: {error}") from None
