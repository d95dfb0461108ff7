"""Several cameras as one: each in a thread of its own, the newest frame of each wins."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from igrip.errors import CameraError
from igrip.perception.cameras import Camera
from igrip.rgbd import Array, RgbdFrame
from igrip.runtime.mailbox import Mailbox


class SeveralCameras:
    """Yields the frames of some cameras as they come, those of each in order of time.

    Nothing queues up: while the reader is busy, a newer frame of a camera replaces the one that
    waits. If one camera fails, iterating raises its error. The cameras are open, and closed by
    :meth:`close`.
    """

    def __init__(self, cameras: Sequence[Camera]) -> None:
        self._cameras = tuple(cameras)
        self._frames: Mailbox[RgbdFrame] = Mailbox()
        self._errors: list[BaseException] = []
        self._running = len(self._cameras)
        self._lock = threading.Lock()
        self._closed = False
        self._threads: list[threading.Thread] = []

    @property
    def note(self) -> str | None:
        """What a user should know of the frames."""
        notes = [getattr(camera, "note", None) for camera in self._cameras]
        return "; ".join(note for note in notes if note) or None

    @property
    def dropped(self) -> int:
        """How many frames were replaced before they were read."""
        return self._frames.replaced

    def __iter__(self) -> Iterator[RgbdFrame]:
        with self._lock:
            if self._threads:
                raise CameraError("cameras can be iterated once")
            self._threads = [
                threading.Thread(target=self._read, args=(camera,), daemon=True)
                for camera in self._cameras
            ]
        for thread in self._threads:
            thread.start()
        while True:
            frame = self._frames.get(timeout=0.5)  # Ctrl-C cannot end a longer wait everywhere
            if self._closed:
                return
            if self._errors:
                raise self._errors[0]
            if frame is not None:
                yield frame
            elif self._frames.finished:
                return

    def _read(self, camera: Camera) -> None:
        try:
            for frame in camera:
                if self._closed:
                    return
                self._frames.put(frame, frame.camera)
        except BaseException as error:
            self._errors.append(error)
            self._frames.close()
        finally:
            with self._lock:
                self._running -= 1
                if not self._running:
                    self._frames.close()

    def close(self) -> None:
        """Close all of them; a waiting iteration ends."""
        self._closed = True
        self._frames.close()
        for camera in self._cameras:
            camera.close()
        for thread in self._threads:
            if thread.is_alive() and thread is not threading.current_thread():
                thread.join(2.0)  # a device is asked again within a fifth of a second


class PlacedCamera:
    """An open camera, or several, whose frames hold where they were taken from.

    ``poses`` are ``world_from_camera``, (4, 4), by the name of the camera.
    """

    def __init__(self, camera: Camera, poses: Mapping[str, Array]) -> None:
        self._camera, self._poses = camera, poses

    @property
    def note(self) -> str | None:
        """What a user should know of the frames."""
        note: str | None = getattr(self._camera, "note", None)
        return note

    def __iter__(self) -> Iterator[RgbdFrame]:
        for frame in self._camera:
            pose = self._poses.get(frame.camera)
            if pose is None:
                raise CameraError(
                    f"where {frame.camera} stands is not known, only "
                    f"{', '.join(self._poses) or 'nothing'}: igrip calibrate"
                )
            yield replace(frame, world_from_camera=pose)

    def close(self) -> None:
        """Release the device."""
        self._camera.close()
