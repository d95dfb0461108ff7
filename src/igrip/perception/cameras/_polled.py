"""What the devices have in common: one is asked for its next frame again and again."""

from __future__ import annotations

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator

from igrip.perception.cameras import CameraError
from igrip.rgbd import RgbdFrame

log = logging.getLogger(__name__)

WAIT = 0.2  # s; a device is never waited for longer at a time, so that close() is soon done
PATIENCE = 4.0  # s without a frame, after which a device is taken to be gone; guess
AHEAD = 0.05  # s by which a frame may seem to come from the future; as GatingConfig's
STRIDE = 8  # pixels between those by which two pictures are compared
WARM_UP = 10.0  # s that the first frame may take; guess


class PolledCamera(ABC):
    """A device that any thread may close while another iterates.

    Attributes
    ----------
    name : str
        Kind and serial number; the ``camera`` of its frames.
    note : str or None
        What a user should know of its frames.
    """

    name: str = "camera"
    note: str | None = None

    def __init__(self) -> None:
        self._closing = threading.Event()
        self._device = threading.Lock()  # held while the device is asked, or let go
        self._released = False

    @abstractmethod
    def _next(self) -> RgbdFrame | None:
        """Return the next frame; None: none came for as long as :data:`WAIT`."""

    @abstractmethod
    def _release(self) -> None:
        """Let the device go."""

    def __iter__(self) -> Iterator[RgbdFrame]:
        last, patience = -1.0, WARM_UP
        asked = time.monotonic()
        before: tuple[bytes, bytes] | None = None
        while True:
            with self._device:
                if self._closing.is_set():
                    return
                try:
                    frame = self._next()
                except CameraError:
                    raise
                except Exception as error:  # whatever a vendor's library raises
                    raise CameraError(
                        f"{self.name} has stopped ({error}); is it still plugged in?"
                    ) from error
            now = time.monotonic()
            # a clock that was set back must not turn time round, one that was set ahead not mute
            # the camera, and a buffer that is sent again not pass for a new picture
            if frame is not None and last < frame.t <= now + AHEAD:
                seen = _trace(frame)
                if seen != before:
                    last, patience, before, asked = frame.t, PATIENCE, seen, now
                    yield frame
                    asked = time.monotonic()
                    continue
            if now - asked > patience:
                raise CameraError(
                    f"{self.name} sent no new picture for {patience:.0f} s; is it still plugged in,"
                    " and does nothing else use it?"
                )

    def close(self) -> None:
        """Let the device go; a waiting iteration ends."""
        self._closing.set()
        with self._device:
            if not self._released:
                self._released = True
                try:
                    self._release()
                except Exception as error:  # it may be gone already, which is what is wanted
                    log.warning(f"{self.name}: {error}")


def _trace(frame: RgbdFrame) -> tuple[bytes, bytes]:
    """Return some pixels, which noise alone makes differ from one picture to the next."""
    depth = b"" if frame.depth is None else frame.depth[::STRIDE, ::STRIDE].tobytes()
    return frame.colour[::STRIDE, ::STRIDE].tobytes(), depth
