"""RealSense cameras through pyrealsense2: colour, and depth aligned to it on the host."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from igrip.errors import CameraError, requires_extra
from igrip.perception.cameras import CAMERAS
from igrip.perception.cameras._options import split_options
from igrip.perception.cameras._polled import WAIT, PolledCamera
from igrip.perception.opencv import load_opencv
from igrip.rgbd import Intrinsics, RgbdFrame

DEFAULTS: dict[str, Any] = {"size": (1280, 720), "depth": (848, 480), "fps": 30.0}
STEP = 8  # pixels between two places where the lens is computed; it bends slowly


def load_realsense() -> Any:
    """Return the module."""
    with requires_extra("pyrealsense2", "realsense", "a RealSense camera"):
        import pyrealsense2
    return pyrealsense2


@CAMERAS.register("realsense")
def open_realsense(rest: str) -> RealSenseCamera:
    """Open ``realsense``, or ``realsense:SERIAL?size=1280x720&depth=848x480&fps=30``."""
    serial, options = split_options(rest, DEFAULTS)
    return RealSenseCamera(serial, **options)


class RealSenseCamera(PolledCamera):
    """A RealSense with colour and depth.

    Parameters
    ----------
    serial : str
        Serial number; empty: any.
    size, depth : 2 ints
        Width and height of the colour picture, and of depth before it is aligned [pixels].
    fps : float
        Frames a second.
    """

    def __init__(
        self, serial: str, size: tuple[int, int], depth: tuple[int, int], fps: float
    ) -> None:
        super().__init__()
        rs = load_realsense()
        there = [d.get_info(rs.camera_info.serial_number) for d in rs.context().query_devices()]
        if not there or (serial and serial not in there):
            raise CameraError(
                f"no RealSense camera {f'{serial} ' if serial else ''}is found: plug it into a "
                "USB 3 port; on Linux it also needs the udev rules of docs/cameras.md"
            )
        config = rs.config()
        if serial:
            config.enable_device(serial)
        config.enable_stream(rs.stream.color, *size, rs.format.rgb8, round(fps))
        config.enable_stream(rs.stream.depth, *depth, rs.format.z16, round(fps))
        self._pipeline = rs.pipeline()
        try:
            device = self._pipeline.start(config).get_device()
        except RuntimeError as error:
            raise CameraError(
                f"the RealSense camera {serial} does not give {size[0]} × {size[1]} with depth of "
                f"{depth[0]} × {depth[1]} at {fps:g} Hz: {error}"
            ) from error
        self.name = f"realsense-{device.get_info(rs.camera_info.serial_number)}"
        for sensor in device.query_sensors():
            if sensor.supports(rs.option.global_time_enabled):
                sensor.set_option(rs.option.global_time_enabled, 1.0)
        self._frames = Converter(rs, self.name, device.first_depth_sensor().get_depth_scale())

    def _next(self) -> RgbdFrame | None:
        there, pair = self._pipeline.try_wait_for_frames(round(WAIT * 1000))
        frame = self._frames.convert(pair) if there else None
        self.device_note = self._frames.note
        return frame

    def _release(self) -> None:
        self._pipeline.stop()


class Converter:
    """Aligns, rectifies and time-stamps what a RealSense sends.

    ``rs`` is the module, ``name`` that of the camera, and ``scale`` one count of depth [m].
    """

    def __init__(self, rs: Any, name: str, scale: float) -> None:
        self._rs, self._name, self._scale = rs, name, scale
        self._align = rs.align(rs.stream.color)
        self._lens: tuple[tuple[Any, ...], Any] | None = None
        self.note: str | None = None
        self._depth_number = -1

    def convert(self, pair: Any) -> RgbdFrame | None:
        """Return the frame of a set of frames; None if a part is missing, or was sent before.

        The library fills a set up with the last depth it had, where no new one came.
        """
        measured = pair.get_depth_frame()
        if not measured or measured.get_frame_number() == self._depth_number:
            return None
        self._depth_number = measured.get_frame_number()
        t = self._time(pair.get_color_frame()) if pair.get_color_frame() else 0.0
        aligned = self._align.process(pair)
        picture, far = aligned.get_color_frame(), aligned.get_depth_frame()
        if not picture or not far:
            return None
        lens = picture.get_profile().as_video_stream_profile().get_intrinsics()
        colour = np.array(picture.get_data(), np.uint8)
        depth = np.asarray(far.get_data()).astype(np.float32) * np.float32(self._scale)
        own = Intrinsics(lens.width, lens.height, lens.fx, lens.fy, lens.ppx, lens.ppy)
        if any(lens.coeffs):
            colour, depth = self._rectified(colour, depth, lens)
        return RgbdFrame(t, colour, depth, own, self._name)

    def _time(self, picture: Any) -> float:
        """Return when a picture was taken on the host's monotonic clock [s]."""
        if picture.get_frame_timestamp_domain() == self._rs.timestamp_domain.hardware_clock:
            self.note = f"{self._name} has no time of exposure; the time of arrival is used"
            return time.monotonic()
        # on the host's wall clock, which the device's is kept in step with
        ago = time.time() - float(picture.get_timestamp()) / 1000.0
        return time.monotonic() - ago

    def _rectified(
        self, colour: NDArray[np.uint8], depth: NDArray[np.float32], lens: Any
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Return the pictures of a camera without distortion and with the same matrix."""
        cv2 = load_opencv("taking distortion out")
        key = (lens.width, lens.height, lens.fx, lens.fy, lens.ppx, lens.ppy, *lens.coeffs)
        if self._lens is None or self._lens[0] != key:
            self._lens = key, lens_map(self._rs, lens)
        maps = self._lens[1]
        return (
            np.asarray(cv2.remap(colour, *maps, cv2.INTER_LINEAR)),
            np.asarray(cv2.remap(depth, *maps, cv2.INTER_NEAREST)),  # never a mean of two depths
        )


def lens_map(rs: Any, lens: Any) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return in which column and row of a distorted picture each pixel of a rectified one lies.

    Computed by the vendor's own function at every eighth pixel, and linear in between; each (h, w).
    """
    us = np.arange(0, lens.width + STEP, STEP)
    vs = np.arange(0, lens.height + STEP, STEP)
    rays = [[[(u - lens.ppx) / lens.fx, (v - lens.ppy) / lens.fy, 1.0] for u in us] for v in vs]
    coarse = np.array([[rs.rs2_project_point_to_pixel(lens, ray) for ray in row] for row in rays])
    places = np.mgrid[: lens.height, : lens.width] / STEP
    u, v = (map_coordinates(coarse[..., k], places, order=1) for k in range(2))
    return u.astype(np.float32), v.astype(np.float32)
