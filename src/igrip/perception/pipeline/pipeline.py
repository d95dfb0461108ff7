"""Camera, hands and objects, each at its own rate in its own thread; one stream of observations."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, Protocol, runtime_checkable

from igrip.errors import IgripError
from igrip.observation import Observation
from igrip.perception.cameras import Camera
from igrip.perception.pipeline.merge import DetectedHands, DetectedObjects, Merger, Result
from igrip.perception.pipeline.worker import Worker
from igrip.rgbd import RgbdFrame
from igrip.runtime.latency import LatencyMeter
from igrip.runtime.loop import TICK
from igrip.runtime.mailbox import Mailbox

MAX_WAIT = 5.0  # s that the last frames of a recording may take
DetectHands = Callable[[RgbdFrame], DetectedHands]
EstimatePoses = Callable[[RgbdFrame, DetectedHands | None], DetectedObjects]


@runtime_checkable
class Naming(Protocol):
    """A stage that gives names to things."""

    def give_name(self, id: str, name: str) -> None:
        """Give a thing a name; an IgripError says why not."""
        ...


class Pipeline:
    """A source of observations; iterate it once.

    A frame that a stage has not begun is replaced by the next, and so is a result that was not
    merged yet: nothing queues up, and the estimator never waits for the slowest.

    Parameters
    ----------
    camera : Camera
        Or several, which say in each frame whose it is.
    new_hands, new_objects : function or None
        Called once for each camera. What they return is called with each of its frames that is
        worked on (and, for objects, the newest hands of that camera), and closed in the end if it
        has a ``close``.
    clock : function
        The clock of the frames [s].

    Attributes
    ----------
    begin : float
        When the observations' times begin, on that clock [s].
    frames : LatencyMeter
        Ages of the frames as they come.

    Raises
    ------
    IgripError
        While iterating, if the camera fails, or a stage for a second of frames in a row.
    """

    def __init__(
        self, camera: Camera, new_hands: Callable[[], DetectHands] | None,
        new_objects: Callable[[], EstimatePoses] | None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:  # fmt: skip
        self._camera, self._clock = camera, clock
        self._new_hands, self._new_objects = new_hands, new_objects
        self._workers: dict[str, list[Worker[Any]]] = {}
        self._stages: list[object] = []
        self._results: Mailbox[Result] = Mailbox()
        self._latest_hands: dict[str, DetectedHands] = {}
        self._lock = threading.Lock()
        self._error: Exception | None = None
        self.frames = LatencyMeter()
        self.begin = clock()
        self._merger = Merger(self.begin)
        self._thread = threading.Thread(target=self._read_camera, name="igrip-camera", daemon=True)

    def __enter__(self) -> Pipeline:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
        self.join()

    def __iter__(self) -> Iterator[Observation]:
        self._thread.start()
        while True:
            result = self._results.get(max(0.0, TICK - self._merger.silence(self._clock())))
            if self._error is not None:
                raise self._error
            if result is not None:
                yield self._merger.observation(result, self._clock())
            elif self._results.finished:
                return
            if self._merger.silence(self._clock()) >= TICK:
                yield self._merger.tick(self._clock())

    @property
    def replaced(self) -> int:
        """Results that newer ones replaced before they were merged."""
        return self._results.replaced

    def close(self) -> None:
        """End everything; an iteration under way ends. From any thread; see :meth:`join`."""
        self._camera.close()
        for worker in self._all_workers():
            worker.close()
        self._results.close()

    def join(self) -> None:
        """Wait until all threads have ended; after :meth:`close`."""
        if self._thread.is_alive():
            self._thread.join(MAX_WAIT)
        for worker in self._all_workers():
            worker.join(MAX_WAIT)

    def latest_hands(self) -> dict[str, DetectedHands]:
        """Return the newest frame of each camera whose hands were looked for, and its hands."""
        with self._lock:
            return dict(self._latest_hands)

    def problems(self) -> list[str]:
        """Return what is wrong with the stages just now."""
        with self._lock:
            problems = [getattr(stage, "problem", None) for stage in self._stages]
        return [problem for problem in problems if problem]

    def give_name(self, id: str, name: str) -> None:
        """Give an unknown thing a name, from the next run on; an IgripError says why not."""
        with self._lock:
            stages = [stage for stage in self._stages if isinstance(stage, Naming)]
        if not stages:
            raise IgripError("no objects are looked for yet")
        stages[0].give_name(id, name)  # cameras of one run share what they know

    def report(self) -> dict[str, dict[str, Any]]:
        """Return for the camera and each stage what was done, how fast, and what was dropped."""
        now = self._clock()
        report = {"camera": {"rate": self.frames.rate(now), **self.frames.summary()}}
        for worker in self._all_workers():
            report[worker.name] = {
                "rate": worker.meter.rate(now), **worker.meter.summary(),
                "skipped": worker.inlet.replaced, "failed": worker.failed,
            }  # fmt: skip
        return report

    def _all_workers(self) -> list[Worker[Any]]:
        with self._lock:
            return [worker for workers in self._workers.values() for worker in workers]

    def _read_camera(self) -> None:
        """Hand frames to the workers, until the camera ends."""
        try:
            for frame in self._camera:
                now = self._clock()
                self.frames.add(now, 0.0, now - frame.t)
                for worker in self._workers_of(frame.camera):
                    worker.inlet.put(frame)
        except Exception as error:  # raised where the observations are read
            self._fail(error)
        for worker in self._all_workers():
            worker.close()
        for worker in self._all_workers():
            worker.join(MAX_WAIT)
        self._results.close()

    def _workers_of(self, camera: str) -> list[Worker[Any]]:
        known = self._workers.get(camera)
        if known is not None:
            return known
        workers: list[Worker[Any]] = []
        if self._new_hands is not None:
            detect = self._new_hands()
            workers.append(self._new_worker(camera, "hands", detect, detect))
        if self._new_objects is not None:
            estimate = self._new_objects()

            def work(frame: RgbdFrame) -> DetectedObjects:
                return estimate(frame, self._latest_hands.get(camera))

            workers.append(self._new_worker(camera, "objects", work, estimate))
        with self._lock:
            self._workers[camera] = workers
        return workers

    def _new_worker(
        self, camera: str, kind: str, work: Callable[[RgbdFrame], Result], stage: object
    ) -> Worker[Any]:
        def on_result(result: Result) -> None:
            if isinstance(result, DetectedHands):
                with self._lock:
                    self._latest_hands[result.frame.camera] = result
            self._results.put(result, (camera, kind))

        def on_failure(error: Exception) -> None:
            self._fail(IgripError(f"{kind} of {camera}: {error}"))

        with self._lock:
            self._stages.append(stage)
        close = getattr(stage, "close", lambda: None)
        return Worker(f"{camera}: {kind}", work, on_result, on_failure, close, self._clock)

    def _fail(self, error: Exception) -> None:
        self._error = self._error or error
        self._results.close()
