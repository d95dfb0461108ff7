"""Camera frames put together from the messages of an ``.mcap`` file."""

from __future__ import annotations

from typing import Any

import numpy as np

from igrip.errors import RecordingError
from igrip.io.mcap import foxglove
from igrip.io.mcap.records import Record
from igrip.rgbd import Array, Intrinsics, RgbdFrame


class FrameAssembler:
    """Keeps depth, calibration and pose of each camera until a colour picture completes a frame."""

    def __init__(self) -> None:
        self._calibrations: dict[str, Intrinsics] = {}
        self._poses: dict[str, Array] = {}
        self._depths: dict[str, tuple[float, Any]] = {}
        self._last: dict[str, float] = {}

    def add(self, record: Record) -> RgbdFrame | None:
        """Add a message; return the frame that it completes.

        Raises
        ------
        RecordingError
            If the message is malformed.
        """
        camera, _, kind = record.topic[1:].rpartition("/")
        if record.topic == "/tf":
            name, pose = foxglove.decode_transform(record.data)
            self._poses[name] = pose
        elif kind == "calibration":
            self._calibrations[camera] = foxglove.decode_calibration(record.data)
        elif kind == "depth":
            self._depths[camera] = record.t, _depth(record)
        elif kind == "colour":
            if record.t < self._last.get(camera, 0.0):
                raise RecordingError("timestamp: decreased")
            self._last[camera] = record.t
            return self._frame(camera, record)
        return None

    def _frame(self, camera: str, record: Record) -> RgbdFrame:
        colour = foxglove.decode_picture(record.data)
        t, depth = self._depths.pop(camera, (None, None))
        depth = depth if t == record.t else None
        intrinsics = self._calibrations.get(camera)
        if intrinsics is None:
            raise RecordingError("no calibration comes before this picture")
        shape = (intrinsics.height, intrinsics.width)
        if colour.shape != (*shape, 3) or (depth is not None and depth.shape != shape):
            raise RecordingError(f"data: {colour.shape[1]} × {colour.shape[0]}, but the "
                                 f"calibration is for {shape[1]} × {shape[0]}")  # fmt: skip
        pose = self._poses.get(camera, np.eye(4))
        return RgbdFrame(record.t, colour, depth, intrinsics, camera, pose)


def _depth(record: Record) -> Any:
    """Return the depth of a message, shape (h, w) float32 [m]."""
    counts = foxglove.decode_picture(record.data)
    if counts.dtype != np.uint16:
        raise RecordingError("data: depth must have 16 bits")
    try:
        unit = float(record.metadata.get("depth_unit_m", "0.001"))
    except ValueError:
        unit = 0.0
    if not 0.0 < unit < 1.0:
        raise RecordingError("depth_unit_m: must be a length in metres")
    metres = (np.arange(65536) * unit).astype(np.float32)
    return metres[counts]
