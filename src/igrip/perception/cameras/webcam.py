"""Any camera that OpenCV opens: colour alone, for detectors that need no depth."""

from __future__ import annotations

import time
from typing import Any

from igrip.errors import CameraError
from igrip.perception.cameras import CAMERAS
from igrip.perception.cameras._options import split_options
from igrip.perception.cameras._polled import PolledCamera
from igrip.perception.lens import Rectifier
from igrip.perception.opencv import load_opencv
from igrip.rgbd import RgbdFrame

DEFAULTS: dict[str, Any] = {"size": (1280, 720), "fps": 30.0, "fov": 0.0, "intrinsics": ""}


@CAMERAS.register("webcam")
def open_webcam(rest: str) -> WebcamCamera:
    """Open ``webcam``, ``webcam:1?size=1280x720&fov=65`` or ``webcam:0?intrinsics=FILE``."""
    which, options = split_options(rest, DEFAULTS)
    if which and not which.isdigit():
        raise CameraError(f"webcam:{which}: must be the number of a camera, such as webcam:0")
    return WebcamCamera(int(which or 0), **options)


class WebcamCamera(PolledCamera):
    """A webcam. Its frames have no depth, and the time at which they arrived.

    Parameters
    ----------
    number : int
        Which, as the operating system counts.
    size : 2 ints
        Wanted width and height [pixels]; it gives what it can.
    fps : float
        Wanted frames a second.
    fov : float
        Field of view across [degrees]; 0: not known.
    intrinsics : str
        File of the intrinsics; see :class:`igrip.perception.lens.read_lens`.
    """

    def __init__(
        self, number: int, size: tuple[int, int], fps: float, fov: float, intrinsics: str
    ) -> None:
        super().__init__()
        self._cv2 = cv2 = load_opencv("a webcam")
        self.name = f"webcam-{number}"
        self._rectifier = Rectifier(intrinsics, fov)
        self.device_note = self._rectifier.note and f"{self.name}: {self._rectifier.note}"
        self._capture = cv2.VideoCapture(number)
        if not self._capture.isOpened():
            self._capture.release()
            raise CameraError(
                f"there is no webcam {number}, or something else uses it: plug one in, or name "
                "another (webcam:1)"
            )
        for key, value in (
            (cv2.CAP_PROP_FRAME_WIDTH, size[0]), (cv2.CAP_PROP_FRAME_HEIGHT, size[1]),
            (cv2.CAP_PROP_FPS, fps), (cv2.CAP_PROP_BUFFERSIZE, 1),
        ):  # fmt: skip
            self._capture.set(key, value)

    def _next(self) -> RgbdFrame | None:
        if not self._capture.grab():
            raise CameraError(f"{self.name} has stopped; is it still plugged in?")
        t = time.monotonic()  # before it is unpacked
        there, bgr = self._capture.retrieve()
        if not there:
            return None
        colour, own = self._rectifier.rectify(self._cv2.cvtColor(bgr, self._cv2.COLOR_BGR2RGB))
        return RgbdFrame(t, colour, None, own, self.name)

    def _release(self) -> None:
        self._capture.release()
