"""Camera frames as the messages that Foxglove and other MCAP readers know, and back.

Colour and depth are ``foxglove.CompressedImage``: JPEG (or PNG), and PNG of 16 bits. Both share one
``foxglove.CameraCalibration``; a ``foxglove.FrameTransform`` places the camera in the world.
``foxglove.ImageAnnotations`` draw the detected hands.
"""

from __future__ import annotations

import importlib
import struct
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.errors import RecordingError, requires_extra
from igrip.io.mcap.messages import Detections
from igrip.rgbd import Array, Intrinsics, RgbdFrame

WORLD = "world"
TYPES = {  # of the messages of each kind of topic
    "colour": "CompressedImage", "depth": "CompressedImage", "calibration": "CameraCalibration",
    "tf": "FrameTransform", "annotations": "ImageAnnotations",
}  # fmt: skip
DEPTH_UNIT = 1e-4  # m; exact for cameras that count in mm or in 0.1 mm, up to 6.5 m
JPEG_QUALITY = 90
MAX_PIXELS = 1 << 26  # of a picture that is read; those of cameras have some 2^20


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


def _stamp(message: Any, t: float) -> Any:
    ns = min(nanoseconds(t), 253402300799 * 10**9)  # the last moment protobuf knows
    message.timestamp.seconds, message.timestamp.nanos = divmod(ns, 10**9)
    return message


def encode_colour(frame: RgbdFrame, lossless: bool = False, quality: int = JPEG_QUALITY) -> bytes:
    """Return the colour picture of a frame as a message."""
    cv2 = _cv2()
    bgr = cv2.cvtColor(frame.colour, cv2.COLOR_RGB2BGR)
    options = [cv2.IMWRITE_PNG_COMPRESSION, 1] if lossless else [cv2.IMWRITE_JPEG_QUALITY, quality]
    _, data = cv2.imencode(".png" if lossless else ".jpg", bgr, options)
    return _picture(frame, data, "png" if lossless else "jpeg")


def encode_depth(frame: RgbdFrame, unit: float = DEPTH_UNIT) -> bytes:
    """Return the depth of a frame as a message; what does not fit into 16 bits becomes 0."""
    assert frame.depth is not None
    cv2 = _cv2()
    counts = frame.depth * np.float32(1.0 / unit)
    counts += np.float32(0.5)
    counts[~((counts >= 0) & (counts < 65536))] = 0  # NaN too
    options = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_SUB]
    _, data = cv2.imencode(".png", counts.astype(np.uint16), options)
    return _picture(frame, data, "png")


def _picture(frame: RgbdFrame, data: NDArray[np.uint8], form: str) -> bytes:
    message = _stamp(schema("CompressedImage").message(), frame.t)
    message.frame_id, message.data, message.format = frame.camera, data.tobytes(), form
    return bytes(message.SerializeToString())


def encode_calibration(frame: RgbdFrame) -> bytes:
    """Return the intrinsics of a frame as a message."""
    message = _stamp(schema("CameraCalibration").message(), frame.t)
    own = frame.intrinsics
    message.frame_id, message.width, message.height = frame.camera, own.width, own.height
    message.distortion_model = "plumb_bob"
    message.D.extend([0.0] * 5)
    message.K.extend(own.matrix.ravel().tolist())
    message.R.extend(np.eye(3).ravel().tolist())
    message.P.extend(np.column_stack([own.matrix, np.zeros(3)]).ravel().tolist())
    return bytes(message.SerializeToString())


def encode_place(frame: RgbdFrame) -> bytes:
    """Return the pose of a frame's camera in the world as a message."""
    message = _stamp(schema("FrameTransform").message(), frame.t)
    message.parent_frame_id, message.child_frame_id = WORLD, frame.camera
    x, y, z = frame.world_from_camera[:3, 3].tolist()
    message.translation.x, message.translation.y, message.translation.z = x, y, z
    a, b, c, w = Rotation.from_matrix(frame.world_from_camera[:3, :3]).as_quat().tolist()
    turn = message.rotation
    turn.x, turn.y, turn.z, turn.w = a, b, c, w
    return bytes(message.SerializeToString())


def encode_annotations(detections: Detections) -> bytes:
    """Return the detected hands as points and labels that a viewer draws over the picture."""
    kind = schema("ImageAnnotations").message
    message = _stamp(kind(), detections.t)
    for hand in detections.hands:
        dots = _stamp(message.points.add(), detections.t)
        dots.type, dots.thickness = dots.POINTS, 4.0
        for u, v in hand.landmarks:
            dots.points.add(x=u, y=v)
        _paint(dots.outline_color)
        if hand.landmarks:
            label = _stamp(message.texts.add(), detections.t)
            label.position.x, label.position.y = hand.landmarks[0]
            label.text, label.font_size = f"{hand.label or 'hand'} {hand.score:.0%}", 16.0
            _paint(label.text_color)
    return bytes(message.SerializeToString())


def _paint(colour: Any) -> None:
    colour.r, colour.g, colour.b, colour.a = 0.1, 0.9, 0.4, 1.0


def decode_picture(data: bytes) -> NDArray[Any]:
    """Return the picture of a message: (h, w, 3) uint8 red, green, blue, or (h, w) uint16.

    Raises
    ------
    RecordingError
        If the message holds no such picture.
    """
    cv2 = _cv2()
    packed = _parse("CompressedImage", data).data
    width, height = _declared_size(packed)
    if width * height > MAX_PIXELS:
        raise RecordingError(f"data: a picture of {width} × {height} is too large")
    try:
        picture = cv2.imdecode(np.frombuffer(packed, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        picture = None
    if picture is None:
        raise RecordingError("data: is no picture")
    if picture.ndim == 3 and picture.shape[2] == 3 and picture.dtype == np.uint8:
        return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
    if picture.ndim == 2 and picture.dtype == np.uint16:
        return np.asarray(picture)
    raise RecordingError(f"data: is neither colour nor depth: {picture.shape} {picture.dtype}")


def _declared_size(data: bytes) -> tuple[int, int]:
    """Return the width and height that a PNG or JPEG declares, before it is unpacked.

    PNG: ISO/IEC 15948, 11.2.1; JPEG: ITU-T T.81, B.2.2.
    """
    if data[:8] == b"\x89PNG\r\n\x1a\n" and len(data) >= 24:
        width, height = struct.unpack(">II", data[16:24])
        return width, height
    at = 2 if data[:2] == b"\xff\xd8" else len(data)
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4])
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):  # a start of frame
            height, width = struct.unpack(">HH", data[at + 5 : at + 9])
            return width, height
        at += 2 + length
    raise RecordingError("data: is no picture, neither PNG nor JPEG")


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


def decode_place(data: bytes) -> tuple[str, Array]:
    """Return the name of a camera and its world_from_camera, shape (4, 4)."""
    message = _parse("FrameTransform", data)
    at, turn = message.translation, message.rotation
    place = np.eye(4)
    place[:3, 3] = at.x, at.y, at.z
    quaternion = np.array([turn.x, turn.y, turn.z, turn.w])
    if not np.isfinite(place).all() or not 0.5 < np.linalg.norm(quaternion) < 2.0:
        raise RecordingError("rotation: must be a unit quaternion, and the translation finite")
    place[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
    return str(message.child_frame_id), place


def _parse(kind: str, data: bytes) -> Any:
    from google.protobuf.message import DecodeError

    try:
        return schema(kind).message.FromString(data)
    except DecodeError as error:
        raise RecordingError(f"is no {kind}: {error}") from None
