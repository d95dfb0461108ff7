"""``serial``: a microcontroller with the framed protocol of :mod:`igrip.devices.base.frames`.

The time to live of each command is that of the permit, at most 150 ms: without another one the
device stops by itself, whatever has become of this program and the line.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from pydantic import Field, model_validator

from igrip.devices import DEVICES
from igrip.devices.base.device import Cause, Condition, DeviceError, DeviceState, Permit
from igrip.devices.base.frames import (
    ALLOW,
    HELLO,
    MAX_TTL,
    QUERY,
    STATE,
    STOP,
    Allow,
    Frame,
    FrameReader,
    Reported,
)  # fmt: skip
from igrip.devices.base.port import open_serial
from igrip.devices.base.settings import DeviceSettings
from igrip.devices.twins.serial import SerialTwin
from igrip.settings import Settings, quantity

CONDITIONS: tuple[Condition, ...] = ("open", "closing", "holding", "fault")
SILENT_AFTER = 0.5  # s without a word from a device that acts


class Line(Protocol):
    """What the device needs of a port."""

    def write(self, data: bytes) -> object:
        """Send bytes, for a bounded time."""

    def read(self, size: int) -> bytes:
        """Return what has come, without waiting."""

    def close(self) -> None:
        """Close it."""


class SerialGrip(Settings):
    """How a grip is told to the microcontroller."""

    number: int = quantity(0, "1", "of the grip, as the microcontroller counts", ge=0, le=255)
    reach: int = quantity(0, "1", "level on the way, 0 to 255", ge=0, le=255)
    grasp: int = quantity(255, "1", "level at the object, 0 to 255", ge=0, le=255)


def _default_grips() -> dict[str, SerialGrip]:
    return {"palmar": SerialGrip(number=1), "pinch": SerialGrip(number=2)}


class SerialSettings(DeviceSettings):
    """A microcontroller that acts on frames.

    Attributes
    ----------
    max_level : int
        No level may be higher: checked here and before each frame.
    """

    baudrate: int = quantity(115200, "Bd", "of the line", gt=0)
    max_level: int = quantity(255, "1", "no level may be higher", ge=0, le=255)
    ramp: float = quantity(0.3, "s", "a level takes this long from 0 to 255", ge=0.0, le=10)
    grips: dict[str, SerialGrip] = Field(default_factory=_default_grips)

    @model_validator(mode="after")
    def _check_levels(self) -> SerialSettings:
        for name, grip in self.grips.items():
            if max(grip.reach, grip.grasp) > self.max_level:
                raise ValueError(f"grips.{name}: a level is above max_level ({self.max_level})")
        return self

    def grip_names(self) -> tuple[str, ...]:
        """Return the grips that have a number."""
        return tuple(self.grips)


@DEVICES.register("serial")
class SerialDevice:
    """Sends frames to a port, and reads what the device says of itself.

    Parameters
    ----------
    settings : SerialSettings
        Port, grips and levels.
    clock : function
        A monotonic clock [s].
    line : Line, optional
        An open port; by default that of the settings is opened.
    """

    Settings = SerialSettings
    min_interval = 0.01

    def __init__(
        self, settings: SerialSettings, clock: Callable[[], float], line: Line | None = None
    ) -> None:
        self._settings, self._clock, self._line = settings, clock, line
        self._reader, self._sequence = FrameReader(), 0
        self._reported: Reported | None = None
        self._heard = self._acted = -1e9
        self._level = 0.0
        self._active = False

    @staticmethod
    def new_twin(settings: DeviceSettings, clock: Callable[[], float]) -> SerialTwin:
        """Return a microcontroller of which there is none."""
        return SerialTwin(clock)

    def open(self) -> None:
        """Open the port; the sequence begins anew."""
        if self._line is None:
            self._line = open_serial(self._settings.port, self._settings.baudrate)
        self._heard = self._clock()
        self._send(HELLO)
        self._send(QUERY)

    def allow(self, permit: Permit) -> None:
        """Send the level of this grip and phase, with the time it may live."""
        grip, now = self._settings.grips[permit.grip], self._clock()
        ttl = min(MAX_TTL, int((permit.until - now) * 1000.0))
        if ttl <= 0:
            return
        self._check_answers(now)
        goal = grip.grasp if permit.phase == "grasp" else grip.reach
        self._level = self._ramped(goal, now)
        level = int(min(self._level, goal, self._settings.max_level))
        self._active, self._acted = True, now
        self._send(ALLOW, Allow(ttl, grip.number, int(permit.phase == "grasp"), level).pack())

    def _ramped(self, goal: float, now: float) -> float:
        if goal <= self._level or self._settings.ramp <= 0.0:
            return goal
        passed = min(now - self._acted, 0.1) if self._active else 0.02
        return min(goal, self._level + 255.0 * passed / self._settings.ramp)

    def _check_answers(self, now: float) -> None:
        """Raise an error if the device says that it has a fault, or nothing for long."""
        state = self.state()
        if state.condition == "fault":
            raise DeviceError(f"{self._settings.port}: the device reports a fault")
        if self._active and now - self._heard > SILENT_AFTER:
            raise DeviceError(f"{self._settings.port}: no answer for {SILENT_AFTER:g} s")

    def stop(self, cause: Cause = "end") -> None:
        """Send the command to stop; while it holds, silence may mean to keep."""
        keep = cause == "silence" and self._settings.when_silent == "keep"
        self._level, self._active = 0.0, False
        if self._line is not None and not (keep and self.state().condition == "holding"):
            self._send(STOP)

    def state(self) -> DeviceState:
        """Return what the device said last."""
        self._read()
        if self._reported is None:
            return DeviceState("open", "has not answered yet")
        return DeviceState(CONDITIONS[self._reported.condition], f"level {self._reported.level}")

    def keep_alive(self) -> None:
        """Ask for its state."""
        if not self._active:
            self._heard = max(self._heard, self._clock() - SILENT_AFTER / 2)
        self._send(QUERY)

    def close(self) -> None:
        """Stop the device and close the port."""
        if self._line is not None:
            try:
                self.stop("close")
            finally:
                self._line.close()
                self._line = None

    def _send(self, kind: int, payload: bytes = b"") -> None:
        if self._line is None:
            raise DeviceError(f"{self._settings.port}: is not open")
        self._sequence = (self._sequence + 1) & 0xFF
        try:
            self._line.write(Frame(self._sequence, kind, payload).encode())
        except OSError as error:  # pyserial's errors are ones
            raise DeviceError(f"{self._settings.port}: {error}") from error

    def _read(self) -> None:
        if self._line is None:
            return
        try:
            data = self._line.read(4096)
        except (OSError, TypeError) as error:  # TypeError: pyserial, of a port that was closed
            raise DeviceError(f"{self._settings.port}: {error}") from error
        for frame in self._reader.feed(data):
            reported = Reported.unpack(frame.payload) if frame.type == STATE else None
            if reported is not None:
                self._reported, self._heard = reported, self._clock()
