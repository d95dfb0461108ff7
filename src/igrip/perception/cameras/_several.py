"""Several cameras as one: each in a thread of its own, the newest frame of each wins."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from igrip.perception.cameras import Camera, CameraError
from igrip.rgbd import Array, RgbdFrame


class SeveralCameras:
    """Yields the frames of some cameras as they come, those of each in order of time.

    Nothing queues up: while the reader is busy, a newer frame of a camera replaces the one that
    waits. If one camera fails, iterating raises its error.

    Parameters
    ----------
    cameras : sequence of Camera
        Open, and closed by :meth:`close`.

    Attributes
    ----------
    dropped : int
        How many frames were replaced before they were read.
    """

    def __init__(self, cameras: Sequence[Camera]) -> None:
        self._cameras = tuple(cameras)
        self.dropped = 0
        self._changed = threading.Condition()
        self._waiting: dict[str, RgbdFrame] = {}  # by camera, the longest waiting first
        self._errors: list[BaseException] = []
        self._running = 0
        self._closed = False
        self._threads: list[threading.Thread] = []

    @property
    def note(self) -> str | None:
        """What a user should know of the frames."""
        notes = [getattr(camera, "note", None) for camera in self._cameras]
        return "; ".join(note for note in notes if note) or None

    def __iter__(self) -> Iterator[RgbdFrame]:
        with self._changed:
            if self._threads:
                raise CameraError("cameras can be iterated once")
            self._running = len(self._cameras)
            self._threads = [
                threading.Thread(target=self._watch, args=(camera,), daemon=True)
                for camera in self._cameras
            ]
        for thread in self._threads:
            thread.start()
        while True:
            with self._changed:
                self._changed.wait_for(
                    lambda: self._waiting or self._errors or self._closed or not self._running,
                    timeout=0.5,  # Ctrl-C cannot end a wait everywhere
                )
                if self._closed:
                    return
                if self._errors:
                    raise self._errors[0]
                if not self._waiting:
                    if self._running:
                        continue
                    return
                frame = self._waiting.pop(next(iter(self._waiting)))
            yield frame

    def _watch(self, camera: Camera) -> None:
        try:
            for frame in camera:
                with self._changed:
                    if self._closed:
                        return
                    self.dropped += frame.camera in self._waiting
                    self._waiting[frame.camera] = frame  # keeps its place in the row
                    self._changed.notify()
        except BaseException as error:
            with self._changed:
                self._errors.append(error)
        finally:
            with self._changed:
                self._running -= 1
                self._changed.notify()

    def close(self) -> None:
        """Close all of them; a waiting iteration ends."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        for camera in self._cameras:
            camera.close()
        for thread in self._threads:
            if thread.is_alive() and thread is not threading.current_thread():
                thread.join(2.0)  # a device is asked again within a fifth of a second


class PlacedCamera:
    """A camera, or several, whose frames say where they were taken from.

    Parameters
    ----------
    camera : Camera
        Open.
    places : mapping of str to (4, 4)
        ``world_from_camera`` by the name of the camera.
    """

    def __init__(self, camera: Camera, places: Mapping[str, Array]) -> None:
        self._camera, self._places = camera, places

    @property
    def note(self) -> str | None:
        """What a user should know of the frames."""
        note: str | None = getattr(self._camera, "note", None)
        return note

    def __iter__(self) -> Iterator[RgbdFrame]:
        for frame in self._camera:
            place = self._places.get(frame.camera)
            if place is None:
                raise CameraError(
                    f"where {frame.camera} stands is not known, only "
                    f"{', '.join(self._places) or 'nothing'}: igrip calibrate"
                )
            yield replace(frame, world_from_camera=place)

    def close(self) -> None:
        """Let the device go."""
        self._camera.close()
