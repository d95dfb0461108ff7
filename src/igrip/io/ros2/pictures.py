"""Pictures and camera calibrations of ROS 2 (``sensor_msgs``) as arrays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.errors import RecordingError, requires_extra
from igrip.io.packed_pictures import MAX_PIXELS, unpack_picture
from igrip.rgbd import Array, Intrinsics

_COLOUR = {"rgb8": [0, 1, 2], "bgr8": [2, 1, 0], "rgba8": [0, 1, 2], "bgra8": [2, 1, 0],
           "8uc3": [2, 1, 0]}  # fmt: skip
_GREY = ("mono8", "8uc1")
_MILLIMETRES, _METRES = ("16uc1", "mono16"), ("32fc1",)
_DEPTH_HEADER = 12  # bytes before the PNG of compressed_depth_image_transport: format, two floats


class Calibration(NamedTuple):
    """A pinhole camera, and the distortion of its raw pictures (``plumb_bob`` and the like)."""

    intrinsics: Intrinsics
    distortion: Array


def decode_image(message: Any) -> NDArray[Any]:
    """Return a ``sensor_msgs/Image``.

    Returns
    -------
    (h, w, 3) uint8
        Red, green, blue; grey pictures have three equal channels.
    (h, w) float32
        Depth [m]; 0 where nothing was measured.

    Raises
    ------
    RecordingError
        If the encoding is not known, or the data do not fit.
    """
    encoding, height, width = message.encoding.lower(), int(message.height), int(message.width)
    if not 0 < height * width <= MAX_PIXELS:
        raise RecordingError(f"a picture of {width} × {height} pixels")
    order = ">" if message.is_bigendian else "<"
    if encoding in _COLOUR:
        channels = 4 if "a8" in encoding else 3
        picture = _rows(message, f"{order}u1", channels)
        return np.ascontiguousarray(picture.reshape(height, width, -1)[:, :, _COLOUR[encoding]])
    if encoding in _GREY:
        return np.repeat(_rows(message, f"{order}u1", 1)[:, :, None], 3, axis=2)
    if encoding in _MILLIMETRES:
        return _metres(_rows(message, f"{order}u2", 1))
    if encoding in _METRES:
        return _metres(_rows(message, f"{order}f4", 1))
    known = ", ".join([*_COLOUR, *_GREY, *_MILLIMETRES, *_METRES])
    raise RecordingError(f"pictures in {message.encoding!r:.40} are not read; known are {known}")


def decode_compressed(message: Any) -> NDArray[Any]:
    """Return a ``sensor_msgs/CompressedImage``, as :func:`decode_image` does."""
    data = bytes(message.data)
    if "compresseddepth" in message.format.replace("_", "").lower():
        data = data[_DEPTH_HEADER:]
    picture = unpack_picture(data)
    return _metres(picture) if picture.ndim == 2 else picture


def decode_camera_info(message: Any) -> Calibration:
    """Return a ``sensor_msgs/CameraInfo``.

    Raises
    ------
    RecordingError
        If it holds no pinhole camera.
    """
    k, d = np.asarray(message.k, dtype=np.float64), np.asarray(message.d, dtype=np.float64)
    intrinsics = Intrinsics(int(message.width), int(message.height), *k[[0, 4, 2, 5]].tolist())
    if not np.isfinite([*intrinsics, *d]).all() or min(intrinsics[:4]) <= 0:
        raise RecordingError("its camera_info holds no calibration (sizes or focal lengths are 0)")
    return Calibration(intrinsics, d if len(d) in (4, 5, 8, 12, 14) else np.zeros(0))


def rectified(picture: NDArray[Any], calibration: Calibration) -> NDArray[Any]:
    """Return a picture without the lens's distortion; depth keeps measured values."""
    if not calibration.distortion.any():
        return picture
    with requires_extra("opencv-python-headless", "hands", "taking distortion out"):
        import cv2
    size = picture.shape[1], picture.shape[0]
    matrix = calibration.intrinsics.matrix
    maps = cv2.initUndistortRectifyMap(
        matrix, calibration.distortion, None, matrix, size, cv2.CV_32FC1
    )
    way = cv2.INTER_NEAREST if picture.ndim == 2 else cv2.INTER_LINEAR
    return np.asarray(cv2.remap(picture, maps[0], maps[1], way))


def _rows(message: Any, kind: str, channels: int) -> NDArray[Any]:
    """Return the rows of a picture, shape (h, w × channels)."""
    height, width, step = int(message.height), int(message.width), int(message.step)
    item = np.dtype(kind).itemsize
    data = np.asarray(message.data, dtype=np.uint8)
    needed = width * channels * item
    if step < needed or len(data) < step * (height - 1) + needed:
        raise RecordingError(f"{len(data)} bytes are too few for {width} × {height} pixels")
    data = np.concatenate([data, np.zeros(max(0, step * height - len(data)), dtype=np.uint8)])
    rows = data[: step * height].reshape(height, step)[:, :needed]
    return np.ascontiguousarray(rows).view(kind).astype(np.dtype(kind).newbyteorder("="))


def _metres(picture: NDArray[Any]) -> NDArray[np.float32]:
    """Return depth [m] from whole millimetres, or from metres with NaN where there is none."""
    if picture.dtype == np.uint16:
        return picture.astype(np.float32) * np.float32(0.001)
    found = picture.astype(np.float32)
    return np.where(np.isfinite(found) & (found > 0.0), found, np.float32(0.0))
