"""Observations from an iterable of this process, such as a camera pipeline."""

from __future__ import annotations

import threading
from collections.abc import Iterable

from igrip.observation import Observation
from igrip.runtime.loop import Loop, Sender


class StreamInput:
    """Submits the observations of a live stream, and ends the run with it.

    The next observation is asked for when the loop is ready for it, so that a stream that keeps
    only the newest gives the newest. An error of the stream is raised by the loop.
    """

    single_sender = True

    def __init__(self, stream: Iterable[Observation]) -> None:
        self._stream = stream

    def start(self, loop: Loop) -> None:
        """Begin to iterate, in a thread."""
        threading.Thread(target=self._run, args=(loop,), daemon=True).start()

    def close(self) -> None:
        """Do nothing: the stream ends by itself, or with the loop."""

    def _run(self, loop: Loop) -> None:
        sender = Sender(name="the source")
        try:
            observations = iter(self._stream)
            while loop.wait_for_demand() and (observation := next(observations, None)) is not None:
                loop.submit(observation, sender)
        except Exception as error:
            loop.finish(error)
        loop.finish()
