"""What a camera is: something that yields frames of colour and, where it has it, depth."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import unquote

from igrip.errors import IgripError
from igrip.registry import Registry
from igrip.rgbd import RgbdFrame


class CameraError(IgripError):
    """A camera is not there, cannot be opened or has stopped; the message says what to do."""


class Camera(Protocol):
    """An open camera. Iterating yields frames in order of time, as they come; blocks in between.

    Frames of several cameras are in order for each of them.
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
        """Let the device go; a waiting iteration ends. May be called twice, and from any thread."""
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
        A file of ``igrip calibrate``, which says where each camera stands.

    Raises
    ------
    UnknownNameError
        If there is no such kind of camera.
    CameraError
        If its package or device is missing; the message says what to install or plug in.
    """
    from igrip.perception.calibration.extrinsics import read_places
    from igrip.perception.cameras._several import PlacedCamera, SeveralCameras

    places = None if calibration is None else read_places(calibration)  # before anything is opened
    opened: list[Camera] = []
    try:
        for one in split_names(name):
            scheme = re.split("[:?]", one, maxsplit=1)[0]
            opened.append(CAMERAS.get(scheme)(one[len(scheme) :].removeprefix(":")))
    except BaseException:
        for camera in opened:
            camera.close()
        raise
    camera = opened[0] if len(opened) == 1 else SeveralCameras(opened)
    return camera if places is None else PlacedCamera(camera, places)


def split_names(name: str) -> list[str]:
    """Return the names that ``+`` joins; a plus within a file's name is none of these."""
    schemes = "|".join(map(re.escape, CAMERAS.names()))
    return re.split(rf"\+(?=(?:{schemes})(?:[:?+]|$))", name)


def read_options(rest: str, defaults: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Take a name's options off.

    Parameters
    ----------
    rest : str
        What follows the scheme, such as ``FILE?speed=0&loop=1``.
    defaults : mapping
        Every option there is; each value is read as the type of its default: str, float, bool or a
        size, such as ``1280x720``.

    Returns
    -------
    str
        What stands before the question mark.
    dict
        All options.

    Raises
    ------
    CameraError
        If an option is unknown or malformed.
    """
    place, _, text = rest.partition("?")
    options = dict(defaults)
    for part in text.split("&") if text else ():
        key, _, value = part.partition("=")
        if key not in defaults:
            raise CameraError(f"no option is named {key!r}; there are: {', '.join(defaults)}")
        try:
            options[key] = _read(unquote(value), defaults[key])
        except ValueError:
            raise CameraError(f"{key}: {value!r} is not of the form {defaults[key]!r}") from None
    return place, options


def _read(text: str, like: Any) -> Any:
    if isinstance(like, bool):
        if text.lower() not in ("0", "1", "true", "false"):
            raise ValueError(text)
        return text.lower() in ("1", "true")
    if isinstance(like, float):
        number = float(text)
        if not 0.0 <= number < 1e6:
            raise ValueError(text)
        return number
    if isinstance(like, tuple):
        width, height = map(int, text.lower().split("x"))
        if min(width, height) < 1:
            raise ValueError(text)
        return width, height
    return text
