"""Camera, hands and objects, each at its own rate in its own thread; one stream of observations."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import Any

from igrip.errors import IgripError
from igrip.observation import Observation
from igrip.perception.cameras import Camera
from igrip.perception.pipeline.merge import TICK, HandsFound, Merge, ObjectsFound
from igrip.perception.pipeline.worker import Worker
from igrip.rgbd import RgbdFrame
from igrip.runtime.latency import LatencyMeter

LAST = 5.0  # s that the last frames of a recording may take
FindHands = Callable[[RgbdFrame], HandsFound]
FindObjects = Callable[[RgbdFrame, HandsFound | None], ObjectsFound]


class Pipeline:
    """A source of observations; iterate it once.

    A frame that a stage has not begun is replaced by the next, and so is a result that was not
    merged yet: nothing queues up, and the estimator never waits for the slowest.

    Parameters
    ----------
    camera : Camera
        Or several, which say in each frame whose it is.
    new_hands, new_objects : function or None
        Called once for each camera; what they return is called with each of its frames that is
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
    replaced : int
        Results that newer ones replaced before they were merged.

    Raises
    ------
    CameraError
        While iterating, if the camera fails.
    IgripError
        While iterating, if a stage fails for a second of frames in a row.
    """

    def __init__(
        self, camera: Camera, new_hands: Callable[[], FindHands] | None,
        new_objects: Callable[[], FindObjects] | None, clock: Callable[[], float] = time.monotonic,
    ) -> None:  # fmt: skip
        self._camera, self._clock = camera, clock
        self._new_hands, self._new_objects = new_hands, new_objects
        self._stages: dict[str, list[Worker[Any]]] = {}
        self._results: deque[tuple[tuple[str, str], HandsFound | ObjectsFound]] = deque()
        self._pictures: dict[str, HandsFound] = {}
        self._finders: list[object] = []
        self._change = threading.Condition()
        self._error: Exception | None = None
        self._over = False
        self.frames = LatencyMeter()
        self.replaced = 0
        self.begin = clock()
        self._merge = Merge(self.begin)
        self._thread = threading.Thread(target=self._watch, name="igrip-camera", daemon=True)

    def __enter__(self) -> Pipeline:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
        self.join()

    def __iter__(self) -> Iterator[Observation]:
        self._thread.start()
        while True:
            found = self._next(max(0.0, TICK - self._merge.silent(self._clock())))
            if self._error is not None:
                raise self._error
            if found is not None:
                yield self._merge.take(found, self._clock())
            elif self._over:
                return
            if self._merge.silent(self._clock()) >= TICK:
                yield self._merge.tick(self._clock())

    def close(self) -> None:
        """End everything; an iteration under way ends. From any thread; see :meth:`join`."""
        self._camera.close()
        stages = self._all_stages()
        for stage in stages:
            stage.close()
        with self._change:
            self._over = True
            self._change.notify_all()

    def join(self) -> None:
        """Wait until all threads have ended; after :meth:`close`."""
        if self._thread.is_alive():
            self._thread.join(LAST)
        for stage in self._all_stages():
            stage.join(LAST)

    def pictures(self) -> dict[str, HandsFound]:
        """Return the newest frame whose hands were looked for, of each camera."""
        with self._change:
            return dict(self._pictures)

    def problems(self) -> list[str]:
        """Return what finders say is wrong with them."""
        with self._change:
            told = [getattr(finder, "problem", None) for finder in self._finders]
        return [problem for problem in told if problem]

    def report(self) -> dict[str, dict[str, Any]]:
        """Return for the camera and each stage what was done, how fast, and what was dropped."""
        now = self._clock()
        told = {"camera": {"rate": self.frames.rate(now), **self.frames.summary()}}
        for stage in self._all_stages():
            told[stage.name] = {
                "rate": stage.meter.rate(now), **stage.meter.summary(),
                "skipped": stage.inlet.replaced, "failed": stage.failed,
            }  # fmt: skip
        return told

    def _all_stages(self) -> list[Worker[Any]]:
        with self._change:
            return [stage for stages in self._stages.values() for stage in stages]

    def _watch(self) -> None:
        """Hand frames to the stages, until the camera ends."""
        try:
            for frame in self._camera:
                now = self._clock()
                self.frames.add(now, 0.0, now - frame.t)
                for stage in self._stages_of(frame.camera):
                    stage.inlet.put(frame)
        except Exception as error:  # what goes wrong here is told where the stream is read
            self._fail(error)
        for stage in self._all_stages():
            stage.close()
        for stage in self._all_stages():
            stage.join(LAST)
        with self._change:
            self._over = True
            self._change.notify_all()

    def _stages_of(self, camera: str) -> list[Worker[Any]]:
        known = self._stages.get(camera)
        if known is not None:
            return known
        stages: list[Worker[Any]] = []
        if self._new_hands is not None:
            find = self._new_hands()
            stages.append(self._stage(camera, "hands", find, find))
        if self._new_objects is not None:
            look = self._new_objects()
            work = lambda frame: look(frame, self._pictures.get(camera))  # noqa: E731
            stages.append(self._stage(camera, "objects", work, look))
        with self._change:
            self._stages[camera] = stages
        return stages

    def _stage(
        self, camera: str, kind: str, work: Callable[[RgbdFrame], Any], finder: object
    ) -> Worker[Any]:
        def hand_on(found: HandsFound | ObjectsFound) -> None:
            self._put((camera, kind), found)

        def give_up(error: Exception) -> None:
            self._fail(IgripError(f"{kind} of {camera}: {error}"))

        with self._change:
            self._finders.append(finder)
        end = getattr(finder, "close", lambda: None)
        return Worker(f"{camera}: {kind}", work, hand_on, give_up, self._clock, end)

    def _put(self, key: tuple[str, str], found: HandsFound | ObjectsFound) -> None:
        with self._change:
            if isinstance(found, HandsFound):
                self._pictures[found.frame.camera] = found
            for k, (other, _) in enumerate(self._results):
                if other == key:  # not merged yet, and old now
                    del self._results[k]
                    self.replaced += 1
                    break
            self._results.append((key, found))
            self._change.notify_all()

    def _next(self, timeout: float) -> HandsFound | ObjectsFound | None:
        with self._change:
            self._change.wait_for(
                lambda: self._results or self._over or self._error is not None, timeout
            )
            return self._results.popleft()[1] if self._results else None

    def _fail(self, error: Exception) -> None:
        with self._change:
            self._error = self._error or error
            self._change.notify_all()
