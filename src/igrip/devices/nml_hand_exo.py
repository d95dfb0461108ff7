"""``nml-hand-exo``: the open hand exoskeleton of the Neuromechatronics Lab (CMU), by its package.

Each motor is held at an angle with a current of its own (``hold_position``), which the firmware
acknowledges with the current that it applies. To stop, motors are released: they have no torque.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Sequence
from typing import Any

from pydantic import model_validator

from igrip.devices import DEVICES
from igrip.devices.base import port as ports
from igrip.devices.base.device import DeviceError
from igrip.devices.base.port import LastWords
from igrip.devices.base.posture import PostureDevice
from igrip.devices.base.settings import DeviceSettings, PostureSettings
from igrip.devices.twins.nml_hand_exo import NmlHandExoTwin
from igrip.errors import requires_extra
from igrip.settings import quantity

MAX_CURRENT = 400.0  # mA of a motor (guess); the firmware's own ceiling is 910


class NmlHandExoSettings(PostureSettings):
    """Postures are angles of ``motors``, in degrees from home.

    Attributes
    ----------
    motors : tuple of int
        Their Dynamixel ids.
    """

    baudrate: int = quantity(57600, "Bd", "of the line", gt=0)
    motors: tuple[int, ...] = (15, 16, 17, 18, 19)
    rest: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0)
    speed: float = quantity(60.0, "°/s", "no motor is commanded faster", "guess", gt=0, le=200)
    limit_ma: float = quantity(100.0, "mA", "a motor may hold with", "guess", gt=0, le=MAX_CURRENT)

    @model_validator(mode="after")
    def _check_motors(self) -> NmlHandExoSettings:
        if len(self.motors) != len(self.rest) or len(set(self.motors)) < len(self.motors):
            raise ValueError("motors: needs an id of its own for each joint of rest")
        if any(motor < 1 or motor > 252 for motor in self.motors):
            raise ValueError("motors: ids are 1 to 252")
        return self


@DEVICES.register("nml_hand_exo")
class NmlHandExoDevice(PostureDevice):
    """Holds motors at angles, with a bounded current each."""

    Settings = NmlHandExoSettings
    min_interval = 0.05

    def __init__(self, settings: NmlHandExoSettings, clock: Callable[[], float]) -> None:
        self.speed = settings.speed
        super().__init__(settings, clock)
        self._port, self._baudrate = settings.port, settings.baudrate
        self._motors, self._limit = settings.motors, min(settings.limit_ma, MAX_CURRENT)
        self._exo: Any = None
        self._last_words: LastWords | None = None

    @staticmethod
    def new_twin(settings: DeviceSettings, clock: Callable[[], float]) -> NmlHandExoTwin:
        """Return the package's own emulator, at the end of a wire."""
        return NmlHandExoTwin(clock)

    def open(self) -> None:
        """Connect, and check that the firmware is one that bounds currents (0.6.2)."""
        with requires_extra("nml-hand-exo", "nml-hand-exo", "the NML hand exoskeleton"):
            from nml_hand_exo.interface._hand_exo import HandExo
            from nml_hand_exo.interface._interfaces import SerialComm

        class Bounded(SerialComm):  # type: ignore[misc]
            """Waits for an answer no longer than a lease allows."""

            def receive(self, *arguments: Any, timeout: float | None = None, **more: Any) -> Any:
                timeout = min(timeout or ports.ANSWER_TIMEOUT, ports.ANSWER_TIMEOUT)
                return super().receive(*arguments, timeout=timeout, **more)

        line = Bounded(self._port, self._baudrate, timeout=0.0)
        self._exo = HandExo(line, command_delimiter="\n", send_delay=0.0)
        self._do("connect")
        line.device.write_timeout = ports.WRITE_TIMEOUT
        self._last_words = LastWords(line.device.fileno(), b"stop:all\ndisable:all\n")
        try:
            version = self._do("firmware_version")
            if version < (0, 6, 2):
                text = ".".join(map(str, version)) or "unknown"
                raise DeviceError(f"{self._port}: firmware {text}; 0.6.2 is needed")
            self._freeze(keep=False)
        except DeviceError:
            self._disconnect()
            raise

    def _move(self, positions: Sequence[float]) -> None:
        for motor, angle in zip(self._motors, positions, strict=True):
            answer = self._do("hold_motor_position", motor, round(angle, 2), self._limit)
            applied = float(str(answer).rpartition("current_mA=")[2] or "nan")
            if not applied <= self._limit:
                raise DeviceError(f"motor {motor} was given {applied:g} mA")

    def _freeze(self, keep: bool) -> None:
        if keep:  # the firmware goes on holding where it is
            return
        failed = None
        for motor in self._motors:  # one that fails must not keep the others from being released
            try:
                self._do("release_motor_hold", motor)
            except DeviceError as error:
                failed = error
        if failed is not None:
            raise failed

    def _release(self) -> None:
        self._freeze(keep=False)

    def keep_alive(self) -> None:
        """Nothing: the line is not watched while no motor is held."""
        if self._exo is None:
            raise DeviceError(f"{self._port}: is not open")

    def _do(self, method: str, *arguments: Any) -> Any:
        """Call a method of the package."""
        if self._exo is None:
            raise DeviceError(f"{self._port}: is not open")
        try:
            with contextlib.redirect_stdout(io.StringIO()):  # it prints warnings
                return getattr(self._exo, method)(*arguments)
        except (OSError, RuntimeError, ValueError, TypeError, AttributeError) as error:
            raise DeviceError(f"{self._port}: {error}") from error

    def close(self) -> None:
        """Release all motors and close the port."""
        if self._exo is not None:
            super().close()

    def _disconnect(self) -> None:
        if self._last_words is not None:
            self._last_words.close()
        self._exo.close()
        self._exo = self._last_words = None
