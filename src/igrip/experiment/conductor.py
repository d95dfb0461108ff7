"""What both screens show, and what the experimenter's orders do."""

from __future__ import annotations

import queue
import shutil
import time
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Any

from igrip.errors import IgripError
from igrip.experiment.progress import AttemptState
from igrip.experiment.session import Session
from igrip.experiment.study import Instructions

ORDERS = ("start", "stop", "repeat", "wrong", "comment", "end_break", "finish")
THANKS = 1.5  # s that "thank you" is shown after a trial
MIN_FREE = 1 << 30  # bytes of the disk below which no trial starts
SECONDS_EACH = 8.0  # of a trial and the pause after it, until some were done


class Phase(StrEnum):
    """What the participant sees."""

    READY = "ready"
    GO = "go"
    STOP = "stop"
    REST = "rest"
    FINISHED = "finished"


class Conductor:
    """Carries out orders, one after the other, in the thread that calls :meth:`step`.

    Parameters
    ----------
    session : Session
        Of the participant.
    instructions : Instructions
        Words of the participant's screen.
    seen : function
        Returns which hands and objects are seen now.
    clock : function
        Monotonic time [s].
    free : function
        Returns how many bytes the disk has left.

    Attributes
    ----------
    problem : str
        Why the newest order could not be carried out, or what stopped a trial.
    cameras : sequence of str
        Their names.
    finished : bool
        Whether the experimenter has ended the session.
    """

    def __init__(
        self, session: Session, instructions: Instructions,
        seen: Callable[[], Mapping[str, bool]], clock: Callable[[], float] = time.monotonic,
        free: Callable[[], int] | None = None,
    ) -> None:  # fmt: skip
        self._session, self._instructions, self._seen = session, instructions, seen
        self._clock = clock
        self._free = free or (lambda: shutil.disk_usage(session.folder.path).free)
        self._orders: queue.SimpleQueue[tuple[str, str]] = queue.SimpleQueue()
        self._study = session.folder.study
        self._started = self._thanked = self._rested = clock() - 1e6
        self._begun, self._done_before = clock(), len(session.progress.done)
        self._resting = session.progress.break_due(self._study.breaks.every)
        self._rested = clock() if self._resting else self._rested
        self.cameras = self._study.cameras
        self.problem = ""
        self.finished = False

    def order(self, name: str, text: str = "") -> bool:
        """Queue an order, from any thread; False: there is no such order."""
        if name not in ORDERS:
            return False
        self._orders.put((name, text))
        return True

    def step(self) -> None:
        """Carry out what was ordered, and stop a trial that is too long or has lost a camera."""
        while True:
            try:
                name, text = self._orders.get_nowait()
            except queue.Empty:
                break
            self.problem = ""
            try:
                self._obey(name, text)
            except (IgripError, OSError) as error:
                self.problem = str(error)
        if not self._session.is_recording:
            return
        failure = self._session.failure()
        if failure is not None:
            self._session.abandon(failure)
            self.problem = f"{failure}; the trial does not count and comes again"
        elif self._clock() - self._started > self._study.max_seconds:
            self.problem = f"stopped after {self._study.max_seconds:g} s"
            self._stop()

    def _obey(self, name: str, text: str) -> None:
        session = self._session
        if name == "start":
            self._start()
        elif name == "stop":
            self._stop()
        elif name == "repeat":
            session.repeat()
        elif name == "wrong":
            session.mark_wrong()
        elif name == "comment":
            session.comment(text)
        elif name == "finish":
            if session.is_recording:
                raise IgripError("a trial is going on: stop it first")
            self.finished = True
        elif name == "end_break" and self._resting:
            session.end_break()
            self._resting = False

    def _start(self) -> None:
        if self._resting:
            raise IgripError("the participant rests: end the break first")
        missing = [name for name, seen in self._seen().items() if not seen]
        if missing:
            raise IgripError(f"not seen: {', '.join(missing)}")
        if self._free() < MIN_FREE:
            raise IgripError(f"only {self._free() / 2**20:.0f} MiB are left on the disk")
        self._session.start()
        self._started = self._clock()

    def _stop(self) -> None:
        self._session.stop()
        self._thanked = self._clock()
        self._resting = self._session.progress.break_due(self._study.breaks.every)
        self._rested = self._clock() if self._resting else self._rested

    @property
    def phase(self) -> Phase:
        """What the participant sees now."""
        if self._session.is_recording:
            return Phase.GO
        if self._clock() - self._thanked < THANKS:
            return Phase.STOP
        if self._session.next_trial is None:
            return Phase.FINISHED
        return Phase.REST if self._resting else Phase.READY

    def participant_screen(self) -> dict[str, Any]:
        """Return what the participant's screen shows."""
        phase, trial = self.phase, self._session.next_trial
        shown = None
        if trial is not None and phase in (Phase.READY, Phase.GO):
            words = self._instructions.words(trial.levels, self._study)
            target = trial.levels["target"]
            shown = {
                "target": target, "object": words.pop("target"), "lines": list(words.values()),
                "side": trial.levels["hand"], "colour": self._study.objects[target].colour,
            }  # fmt: skip
        left = self._study.breaks.seconds - (self._clock() - self._rested)
        return {
            "phase": phase.value, "words": self._instructions.screen[phase.value], "trial": shown,
            "language": self._study.language, "wait": self._instructions.screen["wait"],
            "rest_left": max(0.0, left) if phase is Phase.REST else None,
        }  # fmt: skip

    def experimenter_screen(self) -> dict[str, Any]:
        """Return what the experimenter's screen shows."""
        status = dict(self._session.status())
        done, new = status["done"], status["done"] - self._done_before
        each = (self._clock() - self._begun) / new if new >= 3 else SECONDS_EACH
        states = [one.state for one in self._session.progress.attempts]
        return {
            **status, "phase": self.phase.value, "problem": self.problem,
            "remarks": list(self._session.remarks),
            "cameras": list(self.cameras), "seen": dict(self._seen()),
            "seconds_left": each * (status["of"] - done),
            "disk_left": self._free(),
            "elapsed": self._clock() - self._started if status["recording"] else None,
            "counts": {state.value: states.count(state) for state in AttemptState},
            "to_move": self._to_move(),
            "places": {k: list(v) for k, v in self._study.layouts.places.items()},
            "objects": {id: one.colour for id, one in self._study.objects.items()},
            "participant_sees": self.participant_screen(),
        }  # fmt: skip

    def _to_move(self) -> dict[str, str]:
        """Return the new place of each object that stood elsewhere in the trial before."""
        trial, last = self._session.next_trial, self._session.progress.last
        if trial is None or self._session.is_recording:
            return {}
        before = {} if last is None else self._session.plan.trials[last.trial - 1].layout
        return {id: place for id, place in trial.layout.items() if before.get(id) != place}
