"""Intentions as lines of JSON on standard output."""

from __future__ import annotations

import contextlib
import queue
import sys
import threading

from igrip.runtime.envelope import Envelope

MOST = 256  # intentions that may wait for a reader


class StdoutOutput:
    """A line for each intention.

    Parameters
    ----------
    patient : bool
        True: wait for the reader (a recording that is piped through). False: never; a thread
        writes, and what the reader is too slow for is lost, oldest first, and counted.
    """

    def __init__(self, patient: bool = False) -> None:
        self._patient = patient
        self._sent = self._lost = 0
        self._gone = False
        self._waiting: queue.Queue[Envelope | None] = queue.Queue(MOST)
        if not patient:
            threading.Thread(target=self._work, daemon=True).start()

    def send(self, envelope: Envelope) -> None:
        """Write one line, now or soon.

        Raises
        ------
        BrokenPipeError
            If nobody reads any more.
        """
        if self._gone:
            raise BrokenPipeError("standard output")
        if self._patient:
            self._write(envelope)
            return
        while True:
            try:
                self._waiting.put_nowait(envelope)
                return
            except queue.Full:
                with contextlib.suppress(queue.Empty):
                    self._waiting.get_nowait()
                    self._lost += 1

    def _write(self, envelope: Envelope) -> None:
        sys.stdout.buffer.write(envelope.to_json() + b"\n")
        sys.stdout.buffer.flush()
        self._sent += 1

    def _work(self) -> None:
        while (envelope := self._waiting.get()) is not None:
            try:
                self._write(envelope)
            except (BrokenPipeError, ValueError):
                self._gone = True
                return

    def counts(self) -> dict[str, int]:
        """Return how many lines were written, and how many were lost."""
        return {"sent": self._sent, "lost": self._lost}

    def close(self) -> None:
        """End the thread."""
        with contextlib.suppress(queue.Full):
            self._waiting.put_nowait(None)
