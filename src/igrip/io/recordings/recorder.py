"""Recording frames as they come: what cannot be written in time is dropped and counted."""

from __future__ import annotations

import queue
import threading

from igrip.errors import IgripError, RecordingError
from igrip.io.recordings.mcap_writer import McapWriter
from igrip.rgbd import RgbdFrame

WAITING = 4  # frames of a camera; each is some MB


class Recorder:
    """Encodes and writes frames in threads, one a camera, so that each camera's stay in order.

    Parameters
    ----------
    writer : McapWriter
        Where to; it may be given messages meanwhile, and is not closed here.

    Attributes
    ----------
    taken, dropped : int
        How many frames were taken, and how many of them are lost.
    """

    def __init__(self, writer: McapWriter) -> None:
        self._writer = writer
        self.taken = self.dropped = 0
        self._queues: dict[str, queue.Queue[RgbdFrame | None]] = {}
        self._threads: list[threading.Thread] = []
        self._error: IgripError | None = None

    def take(self, frame: RgbdFrame) -> bool:
        """Take a frame over; return False if it is dropped because others still wait.

        Raises
        ------
        RecordingError
            If writing has failed.
        """
        if self._error is not None:
            raise self._error
        self.taken += 1
        if frame.camera not in self._queues:
            self._queues[frame.camera] = queue.Queue(WAITING)
            self._threads.append(
                threading.Thread(target=self._work, args=(self._queues[frame.camera],), daemon=True)
            )
            self._threads[-1].start()
        try:
            self._queues[frame.camera].put_nowait(frame)
        except queue.Full:
            self.dropped += 1
            return False
        return True

    def close(self) -> None:
        """Write what waits, and end.

        Raises
        ------
        RecordingError
            If writing has failed.
        """
        for waiting in self._queues.values():
            waiting.put(None)
        for thread in self._threads:
            thread.join()
        self._queues.clear()
        self._threads.clear()
        if self._error is not None:
            raise self._error

    def _work(self, waiting: queue.Queue[RgbdFrame | None]) -> None:
        while (frame := waiting.get()) is not None:
            if self._error is not None:
                continue  # take what waits off, so that nobody waits for room
            try:
                self._writer.write_frame(frame)
            except IgripError as error:
                self._error = error
            except Exception as error:  # a frame that cannot be encoded
                self._error = RecordingError(f"{self._writer.path}: {error}")
