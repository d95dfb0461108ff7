"""A recording as a camera: frames at the times they were taken, or as fast as one asks."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from igrip.errors import CameraError, RecordingError
from igrip.io.mcap.reader import McapReader
from igrip.io.ros2.bag_reader import BagReader
from igrip.io.ros2.storage import is_bag
from igrip.perception.cameras import CAMERAS
from igrip.perception.cameras._options import split_options
from igrip.perception.lens import Rectifier
from igrip.perception.opencv import load_opencv
from igrip.rgbd import RgbdFrame

DEFAULTS: dict[str, Any] = {"speed": 1.0, "loop": False, "fov": 0.0, "intrinsics": ""}
VIDEOS = (".mp4", ".avi", ".mkv", ".mov", ".webm")


@CAMERAS.register("replay")
def open_replay(rest: str) -> ReplayCamera:
    """Open ``replay:FILE.mcap``, ``replay:BAG?speed=0`` or ``replay:VIDEO?fov=65&loop=1``."""
    path, options = split_options(rest, DEFAULTS)
    return ReplayCamera(path, **options)


def _opened(reader: Callable[[Path], McapReader | BagReader], path: Path) -> McapReader | BagReader:
    try:
        return reader(path)
    except RecordingError as error:
        raise CameraError(str(error)) from error


class ReplayCamera:
    """A recording (``.mcap``, a bag of ROS 2) with all its cameras, or a video for colour alone.

    Parameters
    ----------
    path : str or Path
        The file.
    speed : float
        1: as it was recorded, the times moved so that the first frame is taken now, on the host's
        monotonic clock. Otherwise the times of the file: 0, as fast as frames are asked for; else,
        so many times faster.
    loop : bool
        Whether to begin again at the end; time goes on.
    fov, intrinsics : float, str
        Of a video; see :class:`igrip.perception.lens.Rectifier`.
    """

    def __init__(
        self, path: str | Path, speed: float, loop: bool, fov: float, intrinsics: str
    ) -> None:
        self.path = Path(path)
        self._speed, self._loop = speed, loop
        self._closing = threading.Event()
        self._video = self.path.suffix.lower() in VIDEOS
        self.note: str | None = None
        self._reader: McapReader | BagReader
        if self._video:
            self._rectifier = Rectifier(intrinsics, fov)
            self.note = self._rectifier.note and f"{self.path.name}: {self._rectifier.note}"
            if not self.path.is_file():
                raise CameraError(f"{self.path}: no such file")
            load_opencv("a video")
        elif self.path.suffix.lower() == ".mcap":
            self._reader = _opened(McapReader, self.path)
        elif self.path.suffix.lower() == ".db3" or is_bag(self.path):
            self._reader = _opened(BagReader, self.path)
        else:
            raise CameraError(
                f"{self.path}: must be .mcap, a bag of ROS 2 or a video ({', '.join(VIDEOS)})"
            )

    def __iter__(self) -> Iterator[RgbdFrame]:
        begin = time.monotonic()
        origin: float | None = None  # time of the first frame
        passed = 0.0  # how long all former rounds were
        while True:
            first = last = step = None
            for frame in self._frames():
                origin = frame.t if origin is None else origin
                first = frame.t if first is None else first
                step = step if last is None or frame.t == last else frame.t - last
                last = frame.t
                since = passed + frame.t - first
                if self._speed:
                    wait = begin + since / self._speed - time.monotonic()
                    self._closing.wait(max(0.0, wait))
                if self._closing.is_set():
                    return
                yield replace(frame, t=(begin if self._speed == 1.0 else origin) + since)
            if first is None or last is None:
                raise CameraError(f"{self.path}: holds no frames")
            if not self._loop:
                return
            passed += last - first + (step or 1 / 30)

    def _frames(self) -> Iterator[RgbdFrame]:
        try:
            yield from self._pictures() if self._video else self._reader.frames()
        except RecordingError as error:
            raise CameraError(str(error)) from error

    def _pictures(self) -> Iterator[RgbdFrame]:
        cv2 = load_opencv("a video")
        capture = cv2.VideoCapture(str(self.path))
        try:
            fps = capture.get(cv2.CAP_PROP_FPS) or 30.0
            number = 0
            while True:
                read, bgr = capture.read()
                if not read:
                    return
                colour, own = self._rectifier.rectify(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB))
                yield RgbdFrame(number / fps, colour, None, own, self.path.stem)
                number += 1
        finally:
            capture.release()

    def close(self) -> None:
        """End a waiting iteration."""
        self._closing.set()
