"""Cameras: whatever yields frames of colour and, where it has it, depth."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol

from igrip.errors import CameraError
from igrip.registry import Registry
from igrip.rgbd import RgbdFrame

__all__ = ["CAMERAS", "Camera", "CameraError", "open_camera", "split_names"]


class Camera(Protocol):
    """An open camera. Iterating yields frames in order of time, as they come; blocks in between.

    Frames of several cameras are in order for each of them. A camera may have a ``note``, a string
    or None: what a user should know of its frames just now.
    """

    def __iter__(self) -> Iterator[RgbdFrame]:
        """Yield frames until the camera is closed or its recording is over.

        Raises
        ------
        CameraError
            If it is unplugged or fails.
        """
        ...

    def close(self) -> None:
        """Release the device; a waiting iteration ends. May be called twice, from any thread."""
        ...


CAMERAS: Registry[Callable[[str], Camera]] = Registry(
    "camera", "igrip.perception.cameras", "igrip.cameras"
)
"""By scheme; a member is called with what follows the colon, or an empty string."""


def open_camera(name: str, calibration: str | Path | None = None) -> Camera:
    """Open a camera, or several at once.

    Parameters
    ----------
    name : str
        ``scheme`` or ``scheme:rest``: ``oak``, ``realsense``, ``webcam:0``, ``replay:FILE``; with
        options as in ``oak?fps=15``; several joined by ``+``, as in ``oak:ID1+oak:ID2``.
    calibration : str or Path, optional
        A file of ``igrip calibrate``, which holds where each camera stands.

    Raises
    ------
    UnknownNameError
        If there is no such kind of camera.
    CameraError
        If its device is missing; the message says what to plug in.
    MissingExtraError
        If its package is missing; the message says what to install.
    """
    from igrip.perception.cameras._several import PlacedCamera, SeveralCameras
    from igrip.perception.placements import read_placements

    # read before anything is opened
    poses = None if calibration is None else read_placements(calibration)
    opened: list[Camera] = []
    try:
        for one in split_names(name):
            scheme = _scheme(one)
            opened.append(CAMERAS.get(scheme)(one[len(scheme) :].removeprefix(":")))
    except BaseException:
        for camera in opened:
            camera.close()
        raise
    camera = opened[0] if len(opened) == 1 else SeveralCameras(opened)
    return camera if poses is None else PlacedCamera(camera, poses)


def split_names(name: str) -> list[str]:
    """Return the names that ``+`` joins; a plus within a file's name is none of these.

    Raises
    ------
    UnknownNameError
        If one of them is of no kind of camera that exists. None is opened.
    """
    schemes = "|".join(map(re.escape, CAMERAS.names()))
    names = re.split(rf"\+(?=(?:{schemes})(?:[:?+]|$))", name)
    for one in names:
        CAMERAS.check(_scheme(one))
    return names


def _scheme(name: str) -> str:
    return re.split("[:?]", name, maxsplit=1)[0]
