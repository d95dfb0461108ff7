"""What the devices have in common: each is polled for its next frame."""

from __future__ import annotations

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

from igrip.errors import CameraError
from igrip.perception.cameras._device_clock import AHEAD, DeviceClock
from igrip.perception.cameras._picture_check import OPEN_SHUTTER, PictureCheck, is_black
from igrip.rgbd import RgbdFrame

log = logging.getLogger(__name__)

WAIT = 0.2  # s; a device is never waited for longer at a time, so that close() is soon done
PATIENCE = 4.0  # s without a new frame, after which a device is taken to have failed; guess
WARM_UP = 10.0  # s that the first frame may take; guess


class CameraFailure(NamedTuple):
    """What a camera sends instead of new pictures, and what to do."""

    what: str
    advice: str


RESTART = "unplug it, plug it in again, and start again"
NO_PICTURE = CameraFailure(
    "no picture", "is it still plugged in, switched on, and used by nothing else?"
)


class PolledCamera(ABC):
    """A device that any thread may close while another iterates.

    Attributes
    ----------
    name : str
        Kind and serial number; the ``camera`` of its frames.
    device_note : str or None
        What a user should know of this device.
    """

    name: str = "camera"
    device_note: str | None = None
    clock: Callable[[], float] = staticmethod(time.monotonic)  # of the frames [s]

    def __init__(self) -> None:
        self._closing = threading.Event()
        self._device = threading.Lock()  # held while the device is asked, or released
        self._released = False
        self._check = PictureCheck()
        self._times: DeviceClock | None = None

    @property
    def note(self) -> str | None:
        """What a user should know of its frames just now."""
        problem = self._check.note and f"{self.name}: {self._check.note}"
        clock = self._times and self._times.event
        return "; ".join(note for note in (self.device_note, clock, problem) if note) or None

    @abstractmethod
    def _next(self) -> RgbdFrame | None:
        """Return the next frame; None: none came for as long as :data:`WAIT`."""

    @abstractmethod
    def _release(self) -> None:
        """Release the device."""

    def __iter__(self) -> Iterator[RgbdFrame]:
        last, patience = -1.0, WARM_UP
        waiting_since = arrived = self.clock()
        fault = NO_PICTURE
        while True:
            with self._device:
                if self._closing.is_set():
                    return
                try:
                    frame = self._next()
                except Exception as error:  # whatever a vendor's library raises
                    if self._closing.is_set():
                        return  # closed meanwhile: it was meant to stop
                    if isinstance(error, CameraError):
                        raise
                    raise CameraError(
                        f"{self.name} has stopped ({error}); is it still plugged in?"
                    ) from error
            now = self.clock()
            if frame is not None:
                arrived = now
                frame = self._dated(frame, now)
                found = self._failure(frame, last, now)
                if found is None:
                    last, patience = frame.t, PATIENCE
                    self._check.update(frame)
                    yield frame
                    waiting_since = self.clock()
                    continue
                fault = found
            if now - waiting_since > patience:
                what, advice = fault if now - arrived < 0.5 * patience else NO_PICTURE
                raise CameraError(f"for {patience:g} s {self.name} has sent {what}; {advice}")

    def _dated(self, frame: RgbdFrame, now: float) -> RgbdFrame:
        """Return a frame with its time by the clock that is followed; as it is where none is."""
        if self._times is None:
            self._times = DeviceClock(self.name)
        event = self._times.event
        t = self._times.update(frame.t, now)
        if self._times.event not in (event, None):
            log.warning(self._times.event)
        return frame if t is None or t == frame.t else replace(frame, t=t)

    def _failure(self, frame: RgbdFrame, last: float, now: float) -> CameraFailure | None:
        """Return why a frame cannot be used; None: it can.

        A clock that was set back must not turn time round, one that was set ahead not mute the
        camera, and a buffer that is sent again not pass for a new picture.
        """
        if frame.t > now + AHEAD:
            return CameraFailure(f"pictures dated {frame.t - now:.1f} s in the future", RESTART)
        if frame.t <= last:
            return CameraFailure("pictures whose time does not increase", RESTART)
        if self._times is not None and self._times.problem is not None:
            return CameraFailure(f"times that cannot be used ({self._times.problem})", RESTART)
        if self._check.is_new(frame):
            return None
        if is_black(frame.colour):
            return CameraFailure("black pictures only", f"{OPEN_SHUTTER}, then start again")
        return CameraFailure("the same picture again and again", RESTART)

    def close(self) -> None:
        """Release the device; a waiting iteration ends."""
        self._closing.set()
        with self._device:
            if not self._released:
                self._released = True
                try:
                    self._release()
                except Exception as error:  # it may be gone already, which is what is wanted
                    log.warning(f"{self.name}: {error}")
