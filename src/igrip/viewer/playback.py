"""A recording as a film: every moment decided beforehand, to be played, stepped and searched."""

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
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot, take_snapshot

RATE = 30.0  # drawings a second


def make_film(
    observations: Iterable[Observation],
    catalog: Catalog,
    config: Config,
    begin: float = -math.inf,
) -> list[Snapshot]:
    """Run the estimator over a recording; one moment for each message from ``begin`` on [s]."""
    estimator = Estimator(catalog, config)
    moments = []
    for observation in observations:
        estimator.update(observation)  # what comes before the beginning is decided all the same
        if observation.t >= begin:
            moments.append(take_snapshot(estimator))
    return moments


class Playhead:
    """Where a film stands, and whether it runs.

    Parameters
    ----------
    times : sequence of float
        Increasing times of the moments [s]; at least one.
    """

    def __init__(self, times: Sequence[float]) -> None:
        self._times = times
        self.index = 0
        self.playing = False
        self.speed = 1.0
        self._t = times[0]

    def play(self) -> None:
        """Run; from the beginning, if it stands at the end."""
        if self.index == len(self._times) - 1:
            self.seek(self._times[0])
        self.playing = True

    def pause(self) -> None:
        """Stand still."""
        self.playing = False

    def step(self, moments: int) -> None:
        """Go some moments forwards or backwards, and stand still there."""
        self.pause()
        self.index = min(max(self.index + moments, 0), len(self._times) - 1)
        self._t = self._times[self.index]

    def seek(self, t: float) -> None:
        """Go to the last moment not later than ``t`` [s]."""
        self._t = min(max(t, self._times[0]), self._times[-1])
        self.index = bisect.bisect_right(self._times, self._t) - 1

    def tick(self, dt: float) -> None:
        """Let ``dt`` seconds pass; at the end it stands still."""
        if not self.playing:
            return
        self.seek(self._t + dt * self.speed)
        if self.index == len(self._times) - 1:
            self.pause()


class Player:
    """Controls on the page that play a film.

    Parameters
    ----------
    viewer : Viewer
        The page.
    film : sequence of Snapshot
        At least one moment.
    """

    def __init__(self, viewer: Viewer, film: Sequence[Snapshot]) -> None:
        self._viewer = viewer
        self._lock = threading.Lock()
        self._film = film
        self.head = Playhead([moment.t for moment in film])
        self._shown: tuple[int, int] | None = None  # which film, which moment
        gui = viewer.server.gui
        with gui.add_folder("Recording", order=-1.0):
            self._button = gui.add_button("Play")
            steps = gui.add_button_group("step", ("|<", "<", ">", ">|"))
            first, last = film[0].t, film[-1].t
            self._slider = gui.add_slider(
                "t [s]", min=first, max=max(last, first + 1e-3), step=1e-3, initial_value=first
            )
            speed = gui.add_dropdown("speed", ("0.1", "0.25", "0.5", "1", "2"), initial_value="1")
        self._button.on_click(lambda _: self._act(self._toggle))
        steps.on_click(lambda event: self._act(lambda: self._step(event.target.value)))
        self._slider.on_update(self._on_slider)
        speed.on_update(
            lambda _: self._act(lambda: setattr(self.head, "speed", float(speed.value)))
        )

    def take(self, film: Sequence[Snapshot]) -> None:
        """Play another film of the same recording from where the last one stands."""
        with self._lock:
            head = Playhead([moment.t for moment in film])
            head.speed, head.playing = self.head.speed, self.head.playing
            head.seek(self._film[self.head.index].t)
            self._film, self.head, self._shown = film, head, None

    def run(self, until: Callable[[], bool] = lambda: False) -> None:
        """Play until the function says so, or for ever."""
        before = time.monotonic()
        while not until():
            time.sleep(1.0 / RATE)
            now = time.monotonic()
            with self._lock:
                self.head.tick(now - before)
                film, index, playing = self._film, self.head.index, self.head.playing
            before = now
            label = "Pause" if playing else "Play"
            if self._button.label != label:
                self._button.label = label
            if self._shown != (id(film), index):
                self._shown = (id(film), index)
                self._viewer.show_film(film, index)
                self._slider.value = round(film[index].t, 3)

    def _act(self, action: Callable[[], None]) -> None:
        with self._lock:
            action()

    def _toggle(self) -> None:
        if self.head.playing:
            self.head.pause()
        else:
            self.head.play()

    def _step(self, where: str) -> None:
        moments = {"|<": -len(self._film), "<": -1, ">": 1, ">|": len(self._film)}
        self.head.step(moments[where])

    def _on_slider(self, event: Any) -> None:
        if event.client is not None:  # moved by a person, not by the film
            with self._lock:
                self.head.pause()
                self.head.seek(float(self._slider.value) + 5e-4)


class ReplayWorker:
    """Makes the film of the estimator that was wanted last, one at a time, in its own thread.

    Parameters
    ----------
    make : function
        From the name of an estimator to its film.
    """

    def __init__(self, make: Callable[[str], Sequence[Snapshot]]) -> None:
        self._make = make
        self._wanted: str | None = None
        self._wake = threading.Condition()

    def want(self, name: str) -> None:
        """Ask for another film; returns at once."""
        with self._wake:
            self._wanted = name
            self._wake.notify()

    def start(self, take: Callable[[Sequence[Snapshot]], None], say: Callable[[str], None]) -> None:
        """Begin to work: hand films to ``take``, and words about it to ``say``."""
        threading.Thread(target=self._run, args=(take, say), daemon=True).start()

    def _run(self, take: Callable[[Sequence[Snapshot]], None], say: Callable[[str], None]) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._wanted is not None)
                name, self._wanted = str(self._wanted), None
            say(f"running {name} …")
            film = self._make(name)
            with self._wake:
                if self._wanted is not None:  # another is wanted by now
                    continue
            take(film)
            say(f"by {name}")
