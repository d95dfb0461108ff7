"""Real cameras of a study: observations and frames of each, kept while a trial goes on."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from igrip.entities import ObjectPose
from igrip.errors import CameraError, IgripError
from igrip.experiment.camera_pictures import Seen, camera_picture
from igrip.experiment.live_predictions import LivePredictions
from igrip.experiment.plan import PlannedTrial
from igrip.experiment.study import Study, StudyError
from igrip.io.mcap.frame_recorder import FrameRecorder
from igrip.io.mcap.writer import McapWriter
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.perception.cameras import Camera
from igrip.rgbd import RgbdFrame

MAX_AGE = 1.0  # s for which a hand or an object counts as seen


class Observer(Protocol):
    """What makes observations of one camera's frames; iterated once, in a thread.

    Attributes
    ----------
    begin : float
        When the times of observations begin, on the clock of the frames [s].
    """

    begin: float

    def __iter__(self) -> Iterator[Observation]: ...

    def close(self) -> None:
        """End the iteration, from any thread."""


class TappedCamera:
    """A camera whose frames are also given to a function.

    Parameters
    ----------
    camera : Camera
        The camera.

    Attributes
    ----------
    tap : function or None
        Called with each frame, in the thread that reads them.
    newest : RgbdFrame or None
        The last frame.
    """

    def __init__(self, camera: Camera) -> None:
        self._camera = camera
        self.tap: Callable[[RgbdFrame], object] | None = None
        self.newest: RgbdFrame | None = None

    def __iter__(self) -> Iterator[RgbdFrame]:
        for frame in self._camera:
            tap, self.newest = self.tap, frame
            if tap is not None:
                tap(frame)
            yield frame

    def close(self) -> None:
        """Close the camera."""
        self._camera.close()


class CameraRecorder:
    """Records the observations and frames of several cameras, each in a file of its own.

    Objects get the study's ids, by their models.

    Parameters
    ----------
    study : Study
        With the objects.
    observers : mapping of str to Observer
        Of each camera.
    taps : mapping of str to TappedCamera
        Their cameras, to keep the pictures; those that are missing keep none.
    clock : function
        Monotonic time [s].
    catalog : Catalog, optional
        With the study's models, for its predictions and pictures.

    Raises
    ------
    StudyError
        If a camera of the study has no observer.
    """

    def __init__(
        self, study: Study, observers: Mapping[str, Observer],
        taps: Mapping[str, TappedCamera] | None = None,
        clock: Callable[[], float] = time.monotonic, catalog: Catalog | None = None,
    ) -> None:  # fmt: skip
        missing = [name for name in study.cameras if name not in observers]
        if missing:
            raise StudyError(f"camera {missing[0]}: give its address, --camera {missing[0]}=oak:ID")
        self._study, self._taps, self._catalog = study, taps or {}, catalog
        self._one = {
            name: _One(study, observers[name], LivePredictions(study, catalog), clock)
            for name in study.cameras
        }

    def seen(self) -> Mapping[str, bool]:
        """Return for each camera whether it sees the study's hands and all objects."""
        names = {id: f"{id} hand" for id in self._study.factors["hand"]}
        names |= {id: id for id in self._study.objects}
        return {
            f"{camera} camera: {name}": id in one.seen()
            for camera, one in self._one.items() for id, name in names.items()
        }  # fmt: skip

    def picture(self, camera: str) -> bytes | None:
        """Return what a camera sees now, with its detections, as JPEG; None: nothing yet."""
        tap = self._taps.get(camera)
        frame = tap.newest if tap is not None else None
        if frame is None:
            return None
        return camera_picture(frame, self._one[camera].seen(), self._catalog)

    def start(self, trial: PlannedTrial, attempt: int, files: Mapping[str, Path]) -> None:
        """Begin to record with all cameras."""
        failure = self.failure()
        if failure is not None:
            raise CameraError(
                f"{failure}; connect it, end the session and give the same command again"
            )
        for camera, path in files.items():
            tap = self._taps.get(camera)
            self._one[camera].start(McapWriter(path), tap)

    def mark(self, name: str, **data: Any) -> None:
        """Write an event into the files."""
        for one in self._one.values():
            one.mark(name, data)

    def failure(self) -> str | None:
        """Return which camera failed."""
        for camera, one in self._one.items():
            if one.error is not None:
                return f"camera {camera}: {one.error}"
        return None

    def stop(self) -> None:
        """End the recording and close the files."""
        errors = [one.stop() for one in self._one.values()]
        problem = self.failure() or next(filter(None, errors), None)
        if problem is not None:
            raise CameraError(problem)

    def close(self) -> None:
        """Close the cameras."""
        for one in self._one.values():
            one.stop()
            one.close()


class _One:
    """One camera: its observer's thread, and the file that is open."""

    def __init__(
        self, study: Study, observer: Observer, predictions: LivePredictions,
        clock: Callable[[], float],
    ) -> None:  # fmt: skip
        self._observer, self._predictions, self._clock = observer, predictions, clock
        self._ids = {one.model: id for id, one in study.objects.items()}
        self._known: dict[str, str] = {}  # ids of the observer to those of the study
        self._seen: dict[str, tuple[float, Seen]] = {}
        self.error: str | None = None
        self._lock = threading.Lock()
        self._writer: McapWriter | None = None
        self._frames: FrameRecorder | None = None
        self._tap: TappedCamera | None = None
        self._t = 0.0
        self._thread = threading.Thread(target=self._run, name="igrip-study-camera", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            for observation in self._observer:
                self._take(observation)
            self.error = self.error or "ended"
        except Exception as error:
            self.error = str(error) or type(error).__name__

    def _take(self, observation: Observation) -> None:
        named = Observation(
            t=observation.t, hands=observation.hands,
            objects=dict(self._named(observation.objects.items())),
        )  # fmt: skip
        now = self._clock()
        for id, entity in (*named.hands.items(), *named.objects.items()):
            if entity is not None:
                self._seen[id] = (now, entity)
        said = self._predictions.of(named)  # between trials too: it knows the hands by their start
        with self._lock:
            self._t = named.t
            if self._writer is not None:
                self._writer.write(named)
                for intention in said:
                    self._writer.write(intention)

    def _named(
        self, objects: Iterable[tuple[str, ObjectPose | None]]
    ) -> Iterator[tuple[str, ObjectPose | None]]:
        """Yield objects with the study's ids; others keep theirs."""
        for id, pose in objects:
            if pose is not None and pose.model is not None:
                self._known[id] = self._ids.get(pose.model, id)
            yield self._known.get(id, id), pose

    def seen(self) -> Mapping[str, Seen]:
        """Return the hands and objects that were seen of late, where they were seen last."""
        oldest = self._clock() - MAX_AGE
        return {id: one for id, (at, one) in tuple(self._seen.items()) if at >= oldest}

    def start(self, writer: McapWriter, tap: TappedCamera | None) -> None:
        """Write into a file from now on."""
        with self._lock:
            self._writer = writer
            self._frames, self._tap = (None if tap is None else FrameRecorder(writer)), tap
        if tap is not None and self._frames is not None:
            tap.tap = partial(self._keep, self._frames)

    def _keep(self, frames: FrameRecorder, frame: RgbdFrame) -> None:
        """Record a frame, at its time on the clock of the observations."""
        frames.add(replace(frame, t=frame.t - self._observer.begin))

    def mark(self, name: str, data: Mapping[str, Any]) -> None:
        """Write an event, at the time of the newest observation."""
        with self._lock:
            if self._writer is not None:
                self._writer.write_event(self._t, name, **data)

    def stop(self) -> str | None:
        """Close the file; return what went wrong."""
        with self._lock:
            writer, self._writer = self._writer, None
            frames, self._frames = self._frames, None
        if self._tap is not None:
            self._tap.tap = None
        problem = None
        for part in (frames, writer):
            try:
                if part is not None:
                    part.close()
            except IgripError as error:
                problem = str(error)
        return problem

    def close(self) -> None:
        """End the observer."""
        self._observer.close()
        self._thread.join(5.0)
