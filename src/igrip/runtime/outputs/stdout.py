"""Intentions as lines of JSON on standard output."""

from __future__ import annotations

import os
import sys
import threading

from igrip.runtime.bounded_queue import BoundedQueue
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS

CLOSE_TIMEOUT = 2.0  # s to write the lines that wait at the end


@OUTPUTS.register("stdout")
class StdoutOutput:
    """Writes a line for each intention.

    Where a recording is piped through, it waits for the reader. Otherwise a thread writes; lines
    that the reader is too slow for are lost, oldest first, and counted.
    """

    def __init__(self, options: Options) -> None:
        self._queue: BoundedQueue[Envelope] = BoundedQueue()
        self._thread = threading.Thread(target=self._run, name="igrip-stdout", daemon=True)
        self._sent = self._accepted = 0
        self._broken = self._closed = False

    def start(self, loop: Loop) -> None:
        """Begin to write."""
        # the descriptor, not the buffered file: a thread that is stuck in that one holds its lock
        self._descriptor = sys.stdout.fileno()
        self._waits = loop.piped
        if not self._waits:
            self._thread.start()

    def send(self, envelope: Envelope) -> None:
        """Write one line, now or soon."""
        if self._broken:
            raise BrokenPipeError("standard output")
        self._accepted += 1
        if self._waits:
            self._write(envelope)
        else:
            self._queue.put(envelope)

    def _write(self, envelope: Envelope) -> None:
        line = envelope.to_json() + b"\n"
        try:
            while line:
                line = line[os.write(self._descriptor, line) :]
        except OSError:
            self._broken = True
            raise
        self._sent += 1

    def _run(self) -> None:
        while not self._queue.finished:
            envelope = self._queue.get()
            if envelope is None:
                continue
            try:
                self._write(envelope)
            except OSError:
                return

    def close(self) -> None:
        """Write what waits, unless the reader is too slow for that; the rest counts as lost."""
        self._queue.close()
        if self._thread.is_alive():
            self._thread.join(CLOSE_TIMEOUT)
        self._closed = True

    def counts(self) -> dict[str, int]:
        """Return how many lines were written, and how many were lost."""
        over = self._closed or self._broken
        lost = self._accepted - self._sent if over else self._queue.counts["dropped"]
        return {"sent": self._sent, "lost": lost}
