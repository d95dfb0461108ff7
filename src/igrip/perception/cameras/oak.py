"""OAK-D cameras through depthai 3: colour, and depth aligned to it by the device itself."""

from __future__ import annotations

import os
import time
from datetime import timedelta
from typing import Any

import numpy as np

from igrip.errors import CameraError, requires_extra
from igrip.perception.cameras import CAMERAS
from igrip.perception.cameras._options import split_options
from igrip.perception.cameras._polled import WAIT, PolledCamera
from igrip.rgbd import Intrinsics, RgbdFrame

COLOUR, DEPTH = "colour", "depth"
STEREO_SIZE = (640, 400)  # of the two grey cameras; more than this is slower than 30 Hz with depth
DEFAULTS: dict[str, Any] = {"size": (1280, 720), "fps": 30.0}
PLUG_IN = (
    "no OAK camera is found: plug it in (USB 3, with its own power for long cables) and end what "
    "else uses it; on Linux it also needs the udev rule of docs/cameras.md"
)


def load_depthai() -> Any:
    """Return the module, with its telemetry off."""
    os.environ["DEPTHAI_TELEMETRY"] = "0"  # before the import: it reports to its vendor otherwise
    with requires_extra("depthai", "oak", "an OAK camera"):
        import depthai
    return depthai


@CAMERAS.register("oak")
def open_oak(rest: str) -> OakCamera:
    """Open ``oak``, ``oak:ID`` (or its IP address) or ``oak:ID?size=1280x720&fps=30``."""
    device, options = split_options(rest, DEFAULTS)
    return OakCamera(device, **options)


class OakCamera(PolledCamera):
    """An OAK-D.

    Colour is undistorted on the device and depth aligned to it there; one message holds both,
    joined by the time of exposure. Intrinsics are those of the device's calibration, carried
    through crop and scaling to the picture that was sent. Times are the middle of the exposure of
    colour, which depthai keeps in step with the host's clock.

    Parameters
    ----------
    device : str
        Serial number, name or IP address; empty: any.
    size : 2 ints
        Width and height [pixels]; the width a multiple of 16, as the device asks.
    fps : float
        Frames a second.
    """

    def __init__(self, device: str, size: tuple[int, int], fps: float) -> None:
        super().__init__()
        if size[0] % 16:
            raise CameraError(f"size: an OAK needs a width that is a multiple of 16, not {size[0]}")
        self._dai = dai = load_depthai()
        if "." not in device and not dai.Device.getAllAvailableDevices():  # an address has dots
            raise CameraError(PLUG_IN)
        try:
            self._oak = dai.Device(dai.DeviceInfo(device)) if device else dai.Device()
        except RuntimeError as error:
            raise CameraError(f"{PLUG_IN} ({error})") from error
        self.name = f"oak-{self._oak.getDeviceId()}"
        try:
            self._offset = clock_offset(dai)
            self._calibration = self._oak.readCalibration()
            self._pipeline = dai.Pipeline(self._oak)
            self._queue = self._build(size, fps)
            self._pipeline.start()
        except RuntimeError as error:
            self._oak.close()
            raise CameraError(f"{self.name} cannot be started: {error}") from error

    def _build(self, size: tuple[int, int], fps: float) -> Any:
        """Return the queue of a pipeline: three cameras, stereo, alignment, joining."""
        dai, pipeline = self._dai, self._pipeline
        sockets = set(self._oak.getConnectedCameras())
        left, right = dai.CameraBoardSocket.CAM_B, dai.CameraBoardSocket.CAM_C
        if not {left, right} <= sockets:
            raise CameraError(f"{self.name} has no stereo pair; an OAK-D is needed")
        camera = pipeline.create(dai.node.Camera).build(dai.CameraBoardSocket.CAM_A)
        colour = camera.requestOutput(
            size, type=dai.ImgFrame.Type.RGB888i, fps=fps, enableUndistortion=True
        )
        stereo = pipeline.create(dai.node.StereoDepth)
        stereo.setDefaultProfilePreset(dai.node.StereoDepth.PresetMode.ROBOTICS)
        stereo.setLeftRightCheck(True)
        stereo.setSubpixel(True)
        for socket, entry in ((left, stereo.left), (right, stereo.right)):
            grey = pipeline.create(dai.node.Camera).build(socket)
            grey.requestOutput(STEREO_SIZE, fps=fps).link(entry)
        if self._oak.getPlatform() == dai.Platform.RVC2:
            colour.link(stereo.inputAlignTo)
            depth = stereo.depth
        else:  # later chips align in a node of its own
            align = pipeline.create(dai.node.ImageAlign)
            stereo.depth.link(align.input)
            colour.link(align.inputAlignTo)
            depth = align.outputAligned
        return join(dai, pipeline, colour, depth, fps)

    def _next(self) -> RgbdFrame | None:
        if not self._pipeline.isRunning():
            raise CameraError(f"{self.name} has stopped; is it still plugged in?")
        group = self._queue.get(timedelta(seconds=WAIT))
        if group is None:
            return None
        return frame_of(self._dai, group, self.name, self._offset, self._fallback)

    def _fallback(self, width: int, height: int) -> Any:
        """Return the camera matrix of the device's calibration for a size, shape (3, 3)."""
        socket = self._dai.CameraBoardSocket.CAM_A
        return self._calibration.getCameraIntrinsics(socket, width, height)

    def _release(self) -> None:
        self._pipeline.stop()
        self._oak.close()


def join(
    dai: Any, pipeline: Any, colour: Any, depth: Any, fps: float, on_host: bool = False
) -> Any:
    """Return the queue of pairs of pictures, exposed together; of those waiting, the newest."""
    sync = pipeline.create(dai.node.Sync)
    sync.setRunOnHost(on_host)
    sync.setSyncThreshold(timedelta(seconds=0.5 / fps))
    colour.link(sync.inputs[COLOUR])
    depth.link(sync.inputs[DEPTH])
    return sync.out.createOutputQueue(maxSize=1, blocking=False)


def clock_offset(dai: Any) -> float:
    """Return what to add to depthai's host times to be on Python's monotonic clock [s].

    Both are the same clock on Linux; of several readings the one that took least counts.
    """
    readings = []
    for _ in range(10):
        before, theirs, after = time.monotonic(), dai.Clock.now(), time.monotonic()
        readings.append((after - before, (before + after) / 2 - theirs.total_seconds()))
    return float(min(readings)[1])


def frame_of(dai: Any, group: Any, name: str, offset: float, fallback: Any) -> RgbdFrame:
    """Return the frame of a pair of pictures, a ``depthai.MessageGroup``.

    ``offset`` is that of its times from the monotonic clock [s]; ``fallback`` gives the camera
    matrix of a width and height, where the picture has none of its own.
    """
    picture, far = group[COLOUR], group[DEPTH]
    colour = np.array(picture.getFrame(), np.uint8)
    height, width = colour.shape[:2]
    counts = np.asarray(far.getFrame())
    if counts.shape != (height, width):
        raise CameraError(f"{name}: depth of {counts.shape[1]} × {counts.shape[0]} is not aligned")
    transform = picture.getTransformation()
    own = transform is not None and transform.isValid()
    own = own and tuple(transform.getSize()) == (width, height)
    k = np.asarray(transform.getIntrinsicMatrix() if own else fallback(width, height))
    if not k[0, 0] > 0.0:
        k = np.asarray(fallback(width, height))
    exposed = picture.getTimestamp(dai.CameraExposureOffset.MIDDLE).total_seconds()
    intrinsics = Intrinsics(
        width, height, float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2])
    )
    depth = counts.astype(np.float32) * np.float32(1e-3)  # it counts in mm
    return RgbdFrame(exposed + offset, colour, depth, intrinsics, name)
