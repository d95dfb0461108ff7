"""``ability-hand``: PSYONIC's Ability Hand, through its package ``ability-hand`` (ah_wrapper).

The package writes its newest command from a thread of its own, for ever. Here no thread is started,
each command follows from a fresh decision. What else is worked around: it makes a file
``config.py`` in the current folder when imported, and ends the program where no hand answers.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

from pydantic import model_validator

from igrip.devices import DEVICES
from igrip.devices.base.device import DeviceError
from igrip.devices.base.port import WRITE_TIMEOUT, LastWords
from igrip.devices.base.posture import PostureDevice
from igrip.devices.base.settings import DeviceSettings, PostureSettings
from igrip.devices.twins.ability_hand import AbilityHandTwin
from igrip.errors import requires_extra
from igrip.settings import quantity

JOINTS = 6
MAX_CURRENT = 2.0  # A of a finger motor that it may report (guess)
REPLY = 2  # positions, currents and velocities
SILENT_AFTER = 0.3  # s without a reply from a hand that moves


class AbilityHandSettings(PostureSettings):
    """Postures are degrees of index, middle, ring, little finger, thumb flexor and rotator."""

    baudrate: int = quantity(460800, "Bd", "of the line", gt=0)
    address: int = quantity(0x50, "1", "of the hand", ge=0, le=255)
    speed: float = quantity(150.0, "°/s", "no joint is commanded faster", "guess", gt=0, le=400)
    max_current: float = quantity(
        1.0, "A", "reported by a motor, at which the hand is stopped", "guess", gt=0, le=MAX_CURRENT
    )
    rest: tuple[float, ...] = (10.0, 10.0, 10.0, 10.0, 10.0, -10.0)

    @model_validator(mode="after")
    def _check_joints(self) -> AbilityHandSettings:
        postures = {"rest": self.rest}
        for grip, posture in self.grips.items():
            postures |= {f"grips.{grip}.reach": posture.reach, f"grips.{grip}.grasp": posture.grasp}
            if posture.grasp_wide is not None:
                postures[f"grips.{grip}.grasp_wide"] = posture.grasp_wide
        for name, joints in postures.items():
            if len(joints) != JOINTS:
                raise ValueError(f"{name}: needs {JOINTS} angles")
            if not all(0 <= a <= 100 for a in joints[:5]) or not -100 <= joints[5] <= 0:
                raise ValueError(f"{name}: fingers 0 to 100°, thumb rotator -100 to 0°")
        return self


@DEVICES.register("ability_hand")
class AbilityHandDevice(PostureDevice):
    """Commands positions; stops by commanding those that were measured."""

    Settings = AbilityHandSettings

    def __init__(self, settings: AbilityHandSettings, clock: Callable[[], float]) -> None:
        self.speed = settings.speed
        super().__init__(settings, clock)
        self._port, self._max_current = settings.port, settings.max_current
        self._baudrate, self._address = settings.baudrate, settings.address
        self._client: Any = None
        self._library: Any = None
        self._heard = -1e9
        self._last_words: LastWords | None = None

    @staticmethod
    def new_twin(settings: DeviceSettings, clock: Callable[[], float]) -> AbilityHandTwin:
        """Return a virtual hand."""
        return AbilityHandTwin(clock)

    def open(self) -> None:
        """Connect, and read where the fingers are; nothing moves."""
        self._library = _library()
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                self._client = self._library.AHSerialClient(
                    port=self._port, baud_rate=self._baudrate, hand_address=self._address,
                    reply_mode=REPLY, read_timeout=0, write_timeout=WRITE_TIMEOUT,
                    read_thread=False, write_thread=False, auto_start_threads=False,
                )  # fmt: skip
        except SystemExit as error:
            raise DeviceError(f"{self._port}: no hand answers") from error
        stop = bytes(self._library.create_duty_msg(reply_mode=REPLY, duties=0, addr=self._address))
        self._last_words = LastWords(self._client._conn._serial.fileno(), stop)
        end = time.monotonic() + 1.0
        while self._positions() is None and time.monotonic() < end:
            self.keep_alive()
            time.sleep(0.02)
        positions = self._positions()
        if positions is None:
            self._disconnect()
            raise DeviceError(f"{self._port}: the hand does not say where its fingers are")
        self._mover.positions = positions

    def _positions(self) -> tuple[float, ...] | None:
        """Return the measured angles, after reading what has come."""
        if self._client is None:
            raise DeviceError(f"{self._port}: is not open")
        for byte in self._client._conn.read(4096) or b"":
            frame = self._client._unstuffer.unstuff_byte(byte)
            packet = self._library.parse_packet(byte_array=frame) if frame else None
            if packet is not None and packet.valid and len(packet.pos) == JOINTS:
                self._heard = self._clock()
                self._client.hand._update_cur(positions=packet.pos, current=packet.cur)
        positions = self._client.hand.get_position()
        return None if positions is None else tuple(positions)

    def _move(self, positions: Sequence[float]) -> None:
        self._positions()
        currents = self._client.hand.get_current() or [0.0]
        if max(map(abs, currents)) > self._max_current:
            raise DeviceError(f"a motor draws more than {self._max_current:g} A")
        if self._phase is not None and self._clock() - self._heard > SILENT_AFTER:
            self._heard = self._clock()  # so that a hand that is opened again gets another chance
            raise DeviceError(f"{self._port}: the hand does not answer")
        self._client.set_position(list(positions))
        self._send()

    def _freeze(self, keep: bool) -> None:
        if keep:  # the hand goes on holding with its newest command
            return
        positions = self._positions()
        if positions is None:
            self._client.set_duty(0)
        else:
            self._mover.positions = positions
            self._client.set_position(list(positions))
        self._send()

    def _release(self) -> None:
        self._positions()
        self._client.set_position(list(self._settings.rest))
        self._send()

    def keep_alive(self) -> None:
        """Ask where its fingers are."""
        if self._client is None:
            raise DeviceError(f"{self._port}: is not open")
        self._client.set_command(self._library.create_misc_msg(0xA2, self._address))
        self._send()
        self._heard = max(self._heard, self._clock() - SILENT_AFTER / 2)

    def _send(self) -> None:
        """Send the command; the package would swallow the error."""
        try:
            self._client._conn._serial.write(bytes(self._client._command))
        except OSError as error:
            raise DeviceError(f"{self._port}: {error}") from error

    def close(self) -> None:
        """Stop the hand and close the port."""
        if self._client is not None:
            super().close()

    def _disconnect(self) -> None:
        if self._last_words is not None:
            self._last_words.close()
        self._client._conn.close()
        self._client = self._last_words = None


def _library() -> ModuleType:
    """Import the package without its file and its settings of the current folder."""
    known = sys.modules.get("igrip_ability_hand")
    if known is not None:
        return known
    settings = ModuleType("config")
    settings.__dict__.update(write_log=False, velocity_warning=False)
    before, path, folder = sys.modules.get("config"), list(sys.path), os.getcwd()
    with tempfile.TemporaryDirectory() as empty:
        sys.modules["config"] = settings
        os.chdir(empty)
        try:
            with requires_extra("ability-hand", "ability-hand", "the Ability Hand"):
                from ah_wrapper import ah_serial_client
        finally:
            os.chdir(folder)
            sys.path[:] = path
            sys.modules.pop("config", None)
            if before is not None:
                sys.modules["config"] = before
    sys.modules["igrip_ability_hand"] = ah_serial_client
    return ah_serial_client  # type: ignore[no-any-return]
