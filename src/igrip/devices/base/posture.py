"""What all devices with joints do alike: postures for grips, a bounded speed, and the end of it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from igrip.devices.base.device import Cause, DeviceError, DeviceState, Permit, Phase
from igrip.devices.base.settings import PostureSettings

LONGEST_STEP = 0.1  # s that a movement advances at once, however long ago the last permit was
FIRST_STEP = 0.02  # s


class Mover:
    """Positions of joints that go to a goal no faster than ``speed`` [units/s].

    Parameters
    ----------
    positions : sequence of float
        Where they are at first.
    """

    def __init__(self, positions: Sequence[float], speed: float) -> None:
        self._speed, self._at = speed, -math.inf
        self.positions = tuple(positions)

    def step(self, goal: Sequence[float], now: float) -> tuple[float, ...]:
        """Return the positions to command now."""
        passed = now - self._at
        passed = FIRST_STEP if not passed <= 1.0 else min(max(0.0, passed), LONGEST_STEP)
        self._at, most = now, self._speed * passed
        self.positions = tuple(
            p + max(-most, min(most, g - p)) for p, g in zip(self.positions, goal, strict=True)
        )
        return self.positions


class PostureDevice(ABC):
    """A hand or an exoskeleton; its subclass knows the vendor's library.

    ``end`` of a lease in good order returns it to rest; every other cause stops it where it is.
    """

    min_interval = 0.03
    speed = 200.0  # units/s; a subclass may have it from its settings

    def __init__(self, settings: PostureSettings, clock: Callable[[], float]) -> None:
        self._settings, self._clock = settings, clock
        self._mover = Mover(settings.rest, self.speed)
        self._phase: Phase | None = None
        self._goal: tuple[float, ...] = settings.rest
        self._kept = False

    def allow(self, permit: Permit) -> None:
        """Move a step further to the posture of the permit's grip."""
        now = self._clock()
        if now >= permit.until:
            return
        self._goal = self._settings.goal(permit.grip, permit.phase, permit.model)
        self._phase, self._kept = permit.phase, False
        self._move(self._mover.step(self._goal, now))

    def stop(self, cause: Cause = "end") -> None:
        """Stop where it is; at the end of a lease in good order, go back to rest."""
        holding = self.state().condition == "holding"
        self._kept = cause == "silence" and holding and self._settings.when_silent == "keep"
        self._phase = self._phase if self._kept else None
        if cause == "end" or (cause == "silence" and holding and not self._kept):
            self._release()
            self._mover.positions = self._settings.rest
        else:
            self._freeze(self._kept)

    def state(self) -> DeviceState:
        """Return what follows from what it was told and measures."""
        if self._phase is None:
            return DeviceState("open", "at rest")
        arrived = self._kept or (self._phase == "grasp" and self._mover.positions == self._goal)
        detail = "keeps what it holds" if self._kept else f"moves: {self._phase}"
        return DeviceState("holding" if arrived else "closing", detail)

    def close(self) -> None:
        """Stop and disconnect."""
        try:
            self.stop("close")
        except DeviceError:
            self._disconnect()
            raise
        self._disconnect()

    @abstractmethod
    def open(self) -> None:
        """Connect."""

    @abstractmethod
    def keep_alive(self) -> None:
        """Keep an idle connection open."""

    @abstractmethod
    def _move(self, positions: Sequence[float]) -> None:
        """Command these positions of the joints; DeviceError if that fails."""

    @abstractmethod
    def _freeze(self, keep: bool) -> None:
        """Stop all joints where they are; ``keep``: with force, as something is held."""

    @abstractmethod
    def _release(self) -> None:
        """Let go, and go back to rest."""

    @abstractmethod
    def _disconnect(self) -> None:
        """Let go of the port."""
