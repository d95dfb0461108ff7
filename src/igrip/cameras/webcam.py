"""Any camera that OpenCV opens: colour alone, for finders that need no depth."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.cameras.base import CAMERAS, CameraError, read_options
from igrip.cameras.polled import PolledCamera
from igrip.rgbd import Intrinsics, RgbdFrame

DEFAULTS: dict[str, Any] = {"size": (1280, 720), "fps": 30.0, "fov": 0.0, "intrinsics": ""}
USUAL_FOV = 65.0  # degrees across; webcams have 55 to 80; guess


@CAMERAS.register("webcam")
def open_webcam(rest: str) -> WebcamCamera:
    """Open ``webcam``, ``webcam:1?size=1280x720&fov=65`` or ``webcam:0?intrinsics=FILE``."""
    which, options = read_options(rest, DEFAULTS)
    if which and not which.isdigit():
        raise CameraError(f"webcam:{which}: must be the number of a camera, such as webcam:0")
    return WebcamCamera(int(which or 0), **options)


def load_cv2() -> Any:
    """Return the module.

    Raises
    ------
    CameraError
        If it is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise CameraError("this needs OpenCV: pip install opencv-python-headless") from None
    return cv2


class Lens:
    """The intrinsics of a colour camera, and its rectification.

    Parameters
    ----------
    path : str
        A JSON file with ``width``, ``height``, ``fx``, ``fy``, ``cx``, ``cy`` [pixels] and perhaps
        ``distortion``, OpenCV's ``k1, k2, p1, p2, k3``; empty: the field of view decides.
    fov : float
        Across the picture [degrees]; 0: not known.

    Attributes
    ----------
    note : str or None
        What is not known and was assumed.

    Raises
    ------
    CameraError
        If the file cannot be read.
    """

    def __init__(self, path: str = "", fov: float = 0.0) -> None:
        self.note: str | None = None
        self._told: Intrinsics | None = None
        self._distortion: list[float] = []
        self._maps: tuple[Any, Any] | None = None
        if path:
            self._told, self._distortion = _read_lens(Path(path))
        elif fov:
            if not 1.0 <= fov <= 170.0:
                raise CameraError(f"fov: must be 1 to 170 degrees, not {fov:g}")
        else:
            fov = USUAL_FOV
            self.note = (
                f"its field of view is assumed to be {fov:g}° across, so distances may be wrong by "
                "a quarter; say ?fov= or ?intrinsics="
            )
        self._fov = fov

    def see(self, colour: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], Intrinsics]:
        """Return the rectified picture and its intrinsics."""
        height, width = colour.shape[:2]
        if self._told is None:
            f = width / 2 / math.tan(math.radians(self._fov) / 2)
            return colour, Intrinsics(width, height, f, f, (width - 1) / 2, (height - 1) / 2)
        if width * self._told.height != height * self._told.width:
            raise CameraError(
                f"the picture is {width} × {height}, but its intrinsics are of "
                f"{self._told.width} × {self._told.height}"
            )
        own = self._told.scaled(width, height)
        if not any(self._distortion):
            return colour, own
        cv2 = load_cv2()
        if self._maps is None or self._maps[0].shape[:2] != (height, width):
            self._maps = cv2.initUndistortRectifyMap(
                own.matrix, np.array(self._distortion), None, own.matrix, (width, height),
                cv2.CV_16SC2,
            )  # fmt: skip
        assert self._maps is not None
        return np.asarray(cv2.remap(colour, *self._maps, cv2.INTER_LINEAR)), own


def _read_lens(path: Path) -> tuple[Intrinsics, list[float]]:
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        own = Intrinsics(int(told["width"]), int(told["height"]),
                         *(float(told[key]) for key in ("fx", "fy", "cx", "cy")))  # fmt: skip
        distortion = [float(value) for value in told.get("distortion", [])]
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise CameraError(f"{path}: is no file of intrinsics: {error!r}") from None
    if not np.isfinite([*own, *distortion]).all() or min(own[:4]) <= 0:
        raise CameraError(f"{path}: sizes and focal lengths must be positive numbers")
    return own, distortion


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
        File of the intrinsics; see :class:`Lens`.

    Raises
    ------
    CameraError
        If OpenCV or the camera is missing.
    """

    def __init__(
        self,
        number: int = 0,
        size: tuple[int, int] = (1280, 720),
        fps: float = 30.0,
        fov: float = 0.0,
        intrinsics: str = "",
    ) -> None:
        super().__init__()
        self._cv2 = cv2 = load_cv2()
        self.name = f"webcam-{number}"
        self._lens = Lens(intrinsics, fov)
        self.note = self._lens.note and f"{self.name}: {self._lens.note}"
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
        colour, own = self._lens.see(self._cv2.cvtColor(bgr, self._cv2.COLOR_BGR2RGB))
        return RgbdFrame(t, colour, None, own, self.name)

    def _release(self) -> None:
        self._capture.release()
