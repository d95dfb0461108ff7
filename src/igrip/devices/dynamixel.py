"""``dynamixel``: a hand of Dynamixel X motors (protocol 2.0), through ROBOTIS' dynamixel-sdk.

The motors' bus watchdog is set to 140 ms with the first command of a lease: without another packet
they stop by themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pydantic import model_validator

from igrip.devices import DEVICES
from igrip.devices.base.device import DeviceError
from igrip.devices.base.port import WRITE_TIMEOUT
from igrip.devices.base.posture import PostureDevice
from igrip.devices.base.settings import DeviceSettings, PostureSettings
from igrip.devices.twins.dynamixel import (
    BUS_WATCHDOG,
    CURRENT_POSITION,
    GOAL_CURRENT,
    GOAL_POSITION,
    OPERATING_MODE,
    TORQUE,
    DynamixelTwin,
)  # fmt: skip
from igrip.errors import requires_extra
from igrip.settings import quantity

MAX_CURRENT = 400.0  # mA of a motor (guess)
WATCHDOG = 7  # in steps of 20 ms
TICKS = 4096 / 360.0  # per degree
MILLIAMPERES = 2.69  # per step of the goal current, X430 series


class DynamixelSettings(PostureSettings):
    """Postures are angles of ``motors`` in degrees, 0 to 360.

    Attributes
    ----------
    motors : tuple of int
        Their ids.
    """

    baudrate: int = quantity(57600, "Bd", "of the line", gt=0)
    motors: tuple[int, ...]
    speed: float = quantity(90.0, "°/s", "no motor is commanded faster", "guess", gt=0, le=400)
    limit_ma: float = quantity(150.0, "mA", "a motor may have", "guess", gt=0, le=MAX_CURRENT)

    @model_validator(mode="after")
    def _check_motors(self) -> DynamixelSettings:
        if len(self.motors) != len(self.rest) or len(set(self.motors)) < len(self.motors):
            raise ValueError("motors: needs an id of its own for each joint of rest")
        if any(motor < 0 or motor > 252 for motor in self.motors):
            raise ValueError("motors: ids are 0 to 252")
        postures = [self.rest]
        for posture in self.grips.values():
            postures += [posture.reach, posture.grasp, posture.grasp_wide or posture.grasp]
        if not all(0.0 <= angle <= 360.0 for joints in postures for angle in joints):
            raise ValueError("angles are 0 to 360°")
        return self


@DEVICES.register("dynamixel")
class DynamixelDevice(PostureDevice):
    """Commands positions with a bounded current, in one packet for all motors."""

    Settings = DynamixelSettings

    def __init__(self, settings: DynamixelSettings, clock: Callable[[], float]) -> None:
        self.speed = settings.speed
        super().__init__(settings, clock)
        self._port_name, self._baudrate = settings.port, settings.baudrate
        self._motors, self._limit = settings.motors, min(settings.limit_ma, MAX_CURRENT)
        self._port: Any = None
        self._packets: Any = None
        self._armed = False

    @staticmethod
    def new_twin(settings: DeviceSettings, clock: Callable[[], float]) -> DynamixelTwin:
        """Return virtual motors."""
        motors = settings.motors if isinstance(settings, DynamixelSettings) else (1, 2)
        return DynamixelTwin(clock, motors)

    def open(self) -> None:
        """Connect; check each motor, and set its mode and current; torque stays off."""
        with requires_extra("dynamixel-sdk", "devices", "Dynamixel motors"):
            import dynamixel_sdk
        self._port = dynamixel_sdk.PortHandler(self._port_name)
        self._packets = dynamixel_sdk.Protocol2PacketHandler()
        try:
            if not self._port.setBaudRate(self._baudrate):
                raise DeviceError(f"{self._port_name}: {self._baudrate} Bd are not known")
        except OSError as error:
            raise DeviceError(f"{self._port_name}: {error}") from error
        self._port.ser.write_timeout = WRITE_TIMEOUT
        for motor in self._motors:
            self._write(motor, BUS_WATCHDOG, 1, 0)
            self._write(motor, TORQUE, 1, 0)
            self._write(motor, OPERATING_MODE, 1, CURRENT_POSITION)
            self._write(motor, GOAL_CURRENT, 2, int(self._limit / MILLIAMPERES))

    def _move(self, positions: Sequence[float]) -> None:
        if not self._armed:
            for motor in self._motors:  # a watchdog that has bitten is cleared by 0
                self._write(motor, BUS_WATCHDOG, 1, 0)
                self._write(motor, BUS_WATCHDOG, 1, WATCHDOG)
            self._armed = True
            self._sync(GOAL_POSITION, 4, [round(p * TICKS) for p in positions])
            self._sync(TORQUE, 1, [1] * len(self._motors))
        self._sync(GOAL_POSITION, 4, [round(p * TICKS) for p in positions])

    def _freeze(self, keep: bool) -> None:
        self._armed = False
        if keep:  # the motors hold where they are, without a watchdog
            for motor in self._motors:
                self._write(motor, BUS_WATCHDOG, 1, 0)
        else:
            self._sync(TORQUE, 1, [0] * len(self._motors))

    def _release(self) -> None:
        self._freeze(keep=False)

    def keep_alive(self) -> None:
        """Nothing: motors without torque need no packets."""
        if self._port is None:
            raise DeviceError(f"{self._port_name}: is not open")

    def _write(self, motor: int, address: int, size: int, value: int) -> None:
        """Write to one motor, and have it acknowledged."""
        if self._port is None:
            raise DeviceError(f"{self._port_name}: is not open")
        data = list(value.to_bytes(size, "little"))
        try:
            result, error = self._packets.writeTxRx(self._port, motor, address, size, data)
        except (OSError, IndexError, TypeError) as failed:
            self._port.is_using = False
            raise DeviceError(f"{self._port_name}: {failed}") from failed
        if result or error:
            text = self._packets.getTxRxResult(result) if result else (
                self._packets.getRxPacketError(error)
            )  # fmt: skip
            raise DeviceError(f"motor {motor}: {text}")

    def _sync(self, address: int, size: int, values: Sequence[int]) -> None:
        """Write to all motors in one packet, which none acknowledges."""
        if self._port is None:
            raise DeviceError(f"{self._port_name}: is not open")
        data: list[int] = []
        for motor, value in zip(self._motors, values, strict=True):
            data += [motor, *value.to_bytes(size, "little")]
        try:
            result = self._packets.syncWriteTxOnly(self._port, address, size, data, len(data))
        except (OSError, TypeError) as error:
            self._port.is_using = False
            raise DeviceError(f"{self._port_name}: {error}") from error
        if result:
            raise DeviceError(f"{self._port_name}: {self._packets.getTxRxResult(result)}")

    def close(self) -> None:
        """Take the torque off and close the port."""
        if self._port is not None:
            super().close()

    def _disconnect(self) -> None:
        self._port.closePort()
        self._port = None
