"""Recording camera frames live: frames that cannot be written in time are dropped and counted."""

from __future__ import annotations

import queue
import threading

from igrip.errors import IgripError, RecordingError
from igrip.io.mcap.writer import McapWriter
from igrip.rgbd import RgbdFrame

MAX_WAITING = 4  # frames of one camera; each has some MB


class FrameRecorder:
    """Encode and write frames in one thread per camera, so that each camera's stay in order.

    Parameters
    ----------
    writer : McapWriter
        Where to write; others may write messages to it meanwhile, and close it afterwards.

    Attributes
    ----------
    received, dropped : int
        How many frames were added, and how many of them were dropped.
    """

    def __init__(self, writer: McapWriter) -> None:
        self._writer = writer
        self.received = self.dropped = 0
        self._queues: dict[str, queue.Queue[RgbdFrame | None]] = {}
        self._threads: list[threading.Thread] = []
        self._error: IgripError | None = None

    def add(self, frame: RgbdFrame) -> bool:
        """Queue a frame for writing; return False if it was dropped because others still wait.

        Raises
        ------
        RecordingError
            If writing has failed.
        """
        if self._error is not None:
            raise self._error
        self.received += 1
        if frame.camera not in self._queues:
            waiting = self._queues[frame.camera] = queue.Queue(MAX_WAITING)
            thread = threading.Thread(target=self._write_frames, args=(waiting,), daemon=True)
            self._threads.append(thread)
            thread.start()
        try:
            self._queues[frame.camera].put_nowait(frame)
        except queue.Full:
            self.dropped += 1
            return False
        return True

    def close(self) -> None:
        """Write the waiting frames and stop.

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

    def _write_frames(self, waiting: queue.Queue[RgbdFrame | None]) -> None:
        while (frame := waiting.get()) is not None:
            if self._error is not None:
                continue  # empty the queue, so that nobody waits for room
            try:
                self._writer.write_frame(frame)
            except IgripError as error:
                self._error = error
            except Exception as error:  # a frame that cannot be encoded
                self._error = RecordingError(f"{self._writer.path}: {error}")
