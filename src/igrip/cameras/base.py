"""What a camera is: something that yields frames of colour and, where it has it, depth."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Protocol

from igrip.errors import IgripError
from igrip.registry import Registry
from igrip.rgbd import RgbdFrame


class CameraError(IgripError):
    """A camera is not there, cannot be opened or has stopped; the message says what to do."""


class Camera(Protocol):
    """An open camera. Iterating yields frames in order of time, as they come; blocks in between."""

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


CAMERAS: Registry[Callable[[str], Camera]] = Registry("camera", "igrip.cameras")
"""By scheme; a member is called with what follows the colon, or an empty string."""


def open_camera(name: str) -> Camera:
    """Open a camera.

    Parameters
    ----------
    name : str
        ``scheme`` or ``scheme:rest``: ``oak``, ``realsense``, ``webcam:0``, ``replay:FILE``.

    Raises
    ------
    UnknownNameError
        If there is no such kind of camera.
    CameraError
        If its package or device is missing; the message says what to install or plug in.
    """
    scheme, _, rest = name.partition(":")
    return CAMERAS.get(scheme)(rest)
