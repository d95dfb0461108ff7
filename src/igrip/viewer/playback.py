"""Playback of a recording on the page: play, pause, step and search."""

from __future__ import annotations

import bisect
import math
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Generic, TypeVar

from igrip.config import Config
from igrip.describe import headline
from igrip.errors import IgripError
from igrip.estimator import Estimator
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.runtime.mailbox import Mailbox
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot, take_snapshot

RATE = 30.0  # drawings per second
LEAD = 0.5  # s before the first decision, where playback begins
R = TypeVar("R")
S = TypeVar("S")


def replay_snapshots(
    observations: Iterable[Observation],
    catalog: Catalog,
    config: Config,
    begin: float = -math.inf,
) -> list[Snapshot]:
    """Run the estimator over a recording; return a snapshot of each message from ``begin`` [s]."""
    estimator = Estimator(catalog, config)
    snapshots = []
    for observation in observations:
        estimator.update(observation)  # also before the beginning, for the filters
        if observation.t >= begin:
            snapshots.append(take_snapshot(estimator))
    return snapshots


class Playhead:
    """The position in a recording, and whether it moves.

    ``times`` are those of the snapshots, increasing, at least one [s].
    """

    def __init__(self, times: Sequence[float]) -> None:
        self._times = times
        self.index = 0
        self.playing = False
        self.speed = 1.0
        self.repeat = False
        self._t = times[0]

    def play(self) -> None:
        """Start moving; from the beginning, if the position is the end."""
        if self.index == len(self._times) - 1:
            self.seek(self._times[0])
        self.playing = True

    def pause(self) -> None:
        """Stop moving."""
        self.playing = False

    def step(self, count: int) -> None:
        """Pause, and go some snapshots forwards or backwards."""
        self.pause()
        self.index = min(max(self.index + count, 0), len(self._times) - 1)
        self._t = self._times[self.index]

    def seek(self, t: float) -> None:
        """Go to the last snapshot not later than ``t`` [s]."""
        self._t = min(max(t, self._times[0]), self._times[-1])
        self.index = bisect.bisect_right(self._times, self._t) - 1

    def tick(self, dt: float) -> None:
        """Let ``dt`` seconds pass; at the end pause, or begin again."""
        if not self.playing:
            return
        if self.repeat and self.index == len(self._times) - 1:
            self.seek(self._times[0])
            return
        self.seek(self._t + dt * self.speed)
        if self.index == len(self._times) - 1 and not self.repeat:
            self.pause()


class Player:
    """Plays the snapshots of a recording, at least one, as people at the pages ask."""

    def __init__(self, viewer: Viewer, snapshots: Sequence[Snapshot]) -> None:
        self._viewer = viewer
        self._lock = threading.Lock()
        self._snapshots = snapshots
        self.head = Playhead([snapshot.t for snapshot in snapshots])
        self._shown: tuple[int, int] | None = None  # which snapshots, and which of them
        self._published: dict[str, Any] | None = None
        self._waits = True  # for the first page, to begin
        viewer.set_up(mode="recording")
        viewer.show_recording(snapshots)
        for name, handler in (
            ("play", self._play), ("step", self._step), ("seek", self._seek),
            ("speed", self._set_speed), ("repeat", self._set_repeat), ("opened_page", self._begin),
        ):  # fmt: skip
            viewer.handle(name, handler)

    def replace(self, snapshots: Sequence[Snapshot], anew: bool = False) -> None:
        """Play other snapshots: of the same recording from the current time on, or ``anew``."""
        with self._lock:
            head = Playhead([snapshot.t for snapshot in snapshots])
            head.speed, head.repeat = self.head.speed, self.head.repeat
            if anew:
                head.seek(first_decision(snapshots))
                head.playing = True
            else:
                head.playing = self.head.playing
                head.seek(self._snapshots[self.head.index].t)
            self._snapshots, self.head, self._shown = snapshots, head, None
        self._viewer.show_recording(snapshots)

    def run(self, until: Callable[[], bool] = lambda: False) -> None:
        """Play until the function returns True, by default for ever."""
        before = time.monotonic()
        while not until():
            time.sleep(1.0 / RATE)
            now = time.monotonic()
            with self._lock:
                self.head.tick(now - before)
                head, snapshots = self.head, self._snapshots
                index = head.index
                state = {
                    "begin": snapshots[0].t, "end": snapshots[-1].t, "playing": head.playing,
                    "speed": head.speed, "repeat": head.repeat,
                }  # fmt: skip
            before = now
            if state != self._published:
                self._published = state
                self._viewer.publish("player", state)
            if self._shown != (id(snapshots), index):
                self._shown = (id(snapshots), index)
                self._viewer.show_moment(snapshots[index])

    def _begin(self, _: Any) -> None:
        """Begin to play where there is something to see, once the first page is open."""
        with self._lock:
            if self._waits and not self.head.playing:
                self.head.seek(first_decision(self._snapshots))
                self.head.playing = True
            self._waits = False

    def _play(self, play: Any) -> None:
        with self._lock:
            self._waits = False
            if play:
                self.head.play()
            else:
                self.head.pause()

    def _step(self, count: Any) -> None:
        with self._lock:
            self.head.step(int(count))

    def _seek(self, t: Any) -> None:
        with self._lock:
            self.head.pause()
            self.head.seek(float(t) + 5e-4)  # the page's times are rounded

    def _set_speed(self, speed: Any) -> None:
        with self._lock:
            self.head.speed = min(max(float(speed), 0.01), 100.0)

    def _set_repeat(self, repeat: Any) -> None:
        with self._lock:
            self.head.repeat = bool(repeat)


def first_decision(snapshots: Sequence[Snapshot]) -> float:
    """Return a time shortly before a hand first reaches for an object, or else moves, or begins."""
    for condition in (
        lambda intention: headline(intention).target is not None,
        lambda intention: intention.status == "reaching",
    ):
        for snapshot in snapshots:
            if any(condition(hand.intention) for hand in snapshot.hands):
                return max(snapshots[0].t, snapshot.t - LEAD)
    return snapshots[0].t


class ReplayWorker(Generic[R, S]):
    """Works on what was requested last, in a thread of its own.

    ``replay`` leads from a request, such as a trial and an estimator, to what is to be shown.
    """

    def __init__(self, replay: Callable[[R], S]) -> None:
        self._replay = replay
        self._requested: Mailbox[R] = Mailbox()

    def request(self, item: R) -> None:
        """Request it; never blocks."""
        self._requested.put(item)

    def start(
        self, on_replayed: Callable[[R, S], None], on_status: Callable[[str], None]
    ) -> None:  # fmt: skip
        """Start working; the functions get the results, and a line about the progress."""

        def work() -> None:
            item = self._requested.get()
            while item is not None:
                on_status(f"running {item} …")
                try:
                    result = self._replay(item)
                except IgripError as error:
                    on_status(str(error))
                    item = self._requested.get()
                    continue
                newer = self._requested.get(timeout=0.0)
                if newer is None:
                    on_replayed(item, result)
                    on_status(str(item))
                    newer = self._requested.get()
                item = newer

        threading.Thread(target=work, daemon=True).start()
