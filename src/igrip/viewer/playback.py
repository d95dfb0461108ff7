"""Playback of a recording on the page: play, pause, step and search."""

from __future__ import annotations

import bisect
import math
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from igrip.config import Config
from igrip.estimator import Estimator
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.runtime.mailbox import Mailbox
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot, take_snapshot

RATE = 30.0  # drawings per second


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
        """Let ``dt`` seconds pass; pause at the end."""
        if not self.playing:
            return
        self.seek(self._t + dt * self.speed)
        if self.index == len(self._times) - 1:
            self.pause()


class Player:
    """Controls on the page that play the snapshots of a recording, at least one."""

    def __init__(self, viewer: Viewer, snapshots: Sequence[Snapshot]) -> None:
        self._viewer = viewer
        self._lock = threading.Lock()
        self._snapshots = snapshots
        self.head = Playhead([snapshot.t for snapshot in snapshots])
        self._shown: tuple[int, int] | None = None  # which snapshots, and which of them
        gui = viewer.server.gui
        with gui.add_folder("Recording", order=-1.0):
            self._button = gui.add_button("Play")
            steps = gui.add_button_group("step", ("|<", "<", ">", ">|"))
            first, last = snapshots[0].t, snapshots[-1].t
            self._slider = gui.add_slider(
                "t [s]", min=first, max=max(last, first + 1e-3), step=1e-3, initial_value=first
            )
            speed = gui.add_dropdown("speed", ("0.1", "0.25", "0.5", "1", "2"), initial_value="1")
        self._button.on_click(lambda _: self._toggle())
        steps.on_click(lambda event: self._step(event.target.value))
        self._slider.on_update(self._on_slider)
        speed.on_update(lambda _: self._set_speed(float(speed.value)))

    def replace(self, snapshots: Sequence[Snapshot]) -> None:
        """Play other snapshots of the same recording, from the current time on."""
        with self._lock:
            head = Playhead([snapshot.t for snapshot in snapshots])
            head.speed, head.playing = self.head.speed, self.head.playing
            head.seek(self._snapshots[self.head.index].t)
            self._snapshots, self.head, self._shown = snapshots, head, None

    def run(self, until: Callable[[], bool] = lambda: False) -> None:
        """Play until the function returns True, by default for ever."""
        before = time.monotonic()
        while not until():
            time.sleep(1.0 / RATE)
            now = time.monotonic()
            with self._lock:
                self.head.tick(now - before)
                snapshots, index, playing = self._snapshots, self.head.index, self.head.playing
            before = now
            label = "Pause" if playing else "Play"
            if self._button.label != label:
                self._button.label = label
            if self._shown != (id(snapshots), index):
                self._shown = (id(snapshots), index)
                self._viewer.show_replay(snapshots, index)
                self._slider.value = round(snapshots[index].t, 3)

    def _toggle(self) -> None:
        with self._lock:
            if self.head.playing:
                self.head.pause()
            else:
                self.head.play()

    def _step(self, button: str) -> None:
        with self._lock:
            count = len(self._snapshots)
            self.head.step({"|<": -count, "<": -1, ">": 1, ">|": count}[button])

    def _set_speed(self, speed: float) -> None:
        with self._lock:
            self.head.speed = speed

    def _on_slider(self, event: Any) -> None:
        if event.client is not None:  # moved by a person, not by the playback
            with self._lock:
                self.head.pause()
                self.head.seek(float(self._slider.value) + 5e-4)


class ReplayWorker:
    """Replays a recording with the estimator that was requested last, in a thread of its own.

    ``replay`` leads from the name of an estimator to the snapshots of the recording.
    """

    def __init__(self, replay: Callable[[str], Sequence[Snapshot]]) -> None:
        self._replay = replay
        self._requested: Mailbox[str] = Mailbox()

    def request(self, name: str) -> None:
        """Request a replay with another estimator; never blocks."""
        self._requested.put(name)

    def start(
        self,
        on_replayed: Callable[[Sequence[Snapshot]], None],
        on_status: Callable[[str], None],
    ) -> None:
        """Start working; the functions get the snapshots and a line about the progress."""

        def work() -> None:
            name = self._requested.get()
            while name is not None:
                on_status(f"running {name} …")
                snapshots = self._replay(name)
                newer = self._requested.get(timeout=0.0)
                if newer is None:
                    on_replayed(snapshots)
                    on_status(f"by {name}")
                    newer = self._requested.get()
                name = newer

        threading.Thread(target=work, daemon=True).start()
