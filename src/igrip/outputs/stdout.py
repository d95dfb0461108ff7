"""Intentions as lines of JSON on standard output."""

from __future__ import annotations

import sys

from igrip.outputs.wire import Envelope


class StdoutOutput:
    """A line for each intention; a reader that is gone ends it without a fuss."""

    def __init__(self) -> None:
        self._sent = 0

    def send(self, envelope: Envelope) -> None:
        """Write one line.

        Raises
        ------
        BrokenPipeError
            If nobody reads any more.
        """
        sys.stdout.buffer.write(envelope.to_json() + b"\n")
        sys.stdout.buffer.flush()
        self._sent += 1

    def counts(self) -> dict[str, int]:
        """Return how many lines were written."""
        return {"sent": self._sent}

    def close(self) -> None:
        """Nothing is left to do."""
