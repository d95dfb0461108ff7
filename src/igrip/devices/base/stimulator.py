"""What all stimulators do alike: patterns for grips, a ramp, the limit, and the end of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import NamedTuple

from igrip.devices.base.device import Cause, DeviceError, DeviceState, Permit, Phase
from igrip.devices.base.limits import MAX_CURRENT, MAX_WIDTH, checked
from igrip.devices.base.settings import StimulatorSettings

LONGEST_STEP = 0.1  # s that a ramp advances at once, however long ago the last permit was
FIRST_STEP = 0.02  # s


class Pulse(NamedTuple):
    """The pulses of one channel from now on."""

    channel: int
    current: float  # mA
    width: int  # µs


class CurrentRamp:
    """Currents that rise no faster than the whole limit within ``duration`` [s]; they fall at once.

    Parameters
    ----------
    limit : float
        mA.
    duration : float
        s.
    """

    def __init__(self, limit: float, duration: float) -> None:
        self._limit, self._rate = limit, limit / duration
        self._currents: dict[int, float] = {}
        self._at: float | None = None

    def reset(self) -> None:
        """Begin anew from nothing."""
        self._currents, self._at = {}, None

    def step(self, goals: dict[int, float], now: float) -> dict[int, float]:
        """Return the currents to give now, by channel."""
        passed = FIRST_STEP if self._at is None else min(max(0.0, now - self._at), LONGEST_STEP)
        self._at = now
        self._currents = {
            channel: min(goal, self._currents.get(channel, 0.0) + self._rate * passed, self._limit)
            for channel, goal in goals.items()
        }
        return dict(self._currents)


class Stimulator(ABC):
    """A stimulator; its subclass knows the vendor's library.

    Parameters
    ----------
    settings : StimulatorSettings
        Patterns and limits.
    clock : function
        A monotonic clock [s].
    """

    min_interval = 0.04

    def __init__(self, settings: StimulatorSettings, clock: Callable[[], float]) -> None:
        self._settings, self._clock = settings, clock
        self._limit = min(settings.limit_ma, MAX_CURRENT)
        self._ramp = CurrentRamp(self._limit, settings.ramp)
        self._phase: Phase | None = None  # None: it does not stimulate
        self._at_goal = False

    def allow(self, permit: Permit) -> None:
        """Stimulate with the pattern of the permit's grip, a step further up its ramp."""
        now = self._clock()
        if now >= permit.until:
            return
        pattern = self._settings.grips[permit.grip]
        channels = pattern.grasp if permit.phase == "grasp" else pattern.reach
        goals = {channel.number: channel.current_ma for channel in channels}
        currents = self._ramp.step(goals, now)
        pulses = [
            Pulse(
                channel.number,
                checked(currents[channel.number], self._limit, "current", "mA"),
                int(checked(channel.width_us, MAX_WIDTH, "width", "µs")),
            )
            for channel in channels
        ]
        self._phase = permit.phase
        self._at_goal = all(currents[number] >= goal for number, goal in goals.items())
        self._stimulate(pulses)

    def stop(self, cause: Cause = "end") -> None:
        """End the stimulation at once, whatever the cause."""
        self._phase = None
        self._ramp.reset()
        self._halt()

    def state(self) -> DeviceState:
        """Return what follows from what it was told: it measures no grasp."""
        if self._phase is None:
            return DeviceState("open", "no stimulation")
        held = self._phase == "grasp" and self._at_goal
        return DeviceState("holding" if held else "closing", f"stimulates: {self._phase}")

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
    def _stimulate(self, pulses: Sequence[Pulse]) -> None:
        """Give these pulses from now on, none on other channels; DeviceError if it does not."""

    @abstractmethod
    def _halt(self) -> None:
        """Give no pulses from now on."""

    @abstractmethod
    def _disconnect(self) -> None:
        """Let go of the port."""
