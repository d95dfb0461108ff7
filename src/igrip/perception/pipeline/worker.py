"""One kind of work in a thread of its own, always on the newest frame."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from typing import Generic, TypeVar

from igrip.rgbd import RgbdFrame
from igrip.runtime.latency import LatencyMeter
from igrip.runtime.mailbox import Mailbox

log = logging.getLogger(__name__)
T = TypeVar("T")
MAX_FAILURES = 30  # frames in a row that may fail before a worker stops; a second of a camera


class Worker(Generic[T]):
    """Works on frames until its inlet is closed.

    Parameters
    ----------
    name : str
        For the screen and in messages.
    work : function
        From a frame to a result.
    on_result : function
        Called with each result.
    on_failure : function
        Called with the error, once too many frames in a row have failed.
    on_end : function
        Called in the worker's thread once all is done.
    clock : function
        A monotonic clock, that of the frames [s].

    Attributes
    ----------
    inlet : Mailbox
        Where frames are put.
    meter : LatencyMeter
        How often, for how long, and how old the frames were by then.
    failed : int
        Frames whose work raised an error.
    """

    def __init__(
        self, name: str, work: Callable[[RgbdFrame], T], on_result: Callable[[T], None],
        on_failure: Callable[[Exception], None], on_end: Callable[[], None],
        clock: Callable[[], float],
    ) -> None:  # fmt: skip
        self.name = name
        self.inlet: Mailbox[RgbdFrame] = Mailbox()
        self.meter = LatencyMeter()
        self.failed = 0
        self._work, self._on_result, self._on_failure = work, on_result, on_failure
        self._on_end, self._clock = on_end, clock
        self._thread = threading.Thread(target=self._run, name=f"igrip-{name}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Accept no more frames; the work at hand is finished."""
        self.inlet.close()

    def join(self, timeout: float) -> None:
        """Wait until the last frame is done, at most so long [s]."""
        self._thread.join(timeout)

    def _run(self) -> None:
        try:
            self._work_until_closed()
        finally:
            self._on_end()

    def _work_until_closed(self) -> None:
        in_a_row = 0
        while not self.inlet.finished:
            frame = self.inlet.get()
            if frame is None:
                continue
            begin = self._clock()
            try:
                result = self._work(frame)
            except Exception as error:  # one picture that cannot be read must not end the pipeline
                self.failed += 1
                in_a_row += 1
                if in_a_row == 1:
                    log.warning("%s: a frame failed: %s", self.name, error)
                if in_a_row >= MAX_FAILURES:
                    self._on_failure(error)
                    return
                continue
            in_a_row = 0
            now = self._clock()
            self.meter.add(now, now - begin, now - frame.t)
            self._on_result(result)
