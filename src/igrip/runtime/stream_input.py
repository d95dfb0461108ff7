"""Observations from an iterable that runs in this process, such as a camera pipeline."""

from __future__ import annotations

import threading
from collections.abc import Iterable

from igrip.observation import Observation
from igrip.runtime.connections import Receiver, Sender


class StreamInput:
    """Submits the observations of a live stream, and ends the loop with it.

    The next observation is asked for when the loop is ready for it, so that a stream that keeps
    only the newest gives the newest.

    Parameters
    ----------
    stream : iterable of Observation
        Dated by the clock of the run. An error that it raises is raised by the loop.
    """

    def __init__(self, stream: Iterable[Observation]) -> None:
        self._stream = stream

    def start(self, loop: Receiver) -> None:
        """Begin to iterate, in a thread."""
        threading.Thread(target=self._run, args=(loop,), name="igrip-stream", daemon=True).start()

    def close(self) -> None:
        """Do nothing: the stream ends by itself, or with the loop."""

    def _run(self, loop: Receiver) -> None:
        sender, error = Sender(), None
        try:
            observations = iter(self._stream)
            while loop.wait_for_demand() and (observation := next(observations, None)) is not None:
                loop.submit(observation, sender)
        except Exception as raised:
            error = raised
        loop.finish(error)
