"""``p24``: Hasomed's P24, through its own library science_mode_4 (mid level).

The mid level stimulates by itself between two updates, for 2 s at most. Each update here follows
from a fresh decision, and the end of the lease sends the command to stop.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Coroutine, Sequence
from typing import Any

from igrip.devices import DEVICES
from igrip.devices.base import port as ports
from igrip.devices.base.device import DeviceError
from igrip.devices.base.gate import Gate
from igrip.devices.base.limits import MAX_WIDTH
from igrip.devices.base.port import WRITE_TIMEOUT, LastWords
from igrip.devices.base.sciencemode import ML_STOP, Packet, encode4, largest4
from igrip.devices.base.settings import DeviceSettings, StimulatorSettings
from igrip.devices.base.stimulator import Pulse, Stimulator
from igrip.devices.twins.p24 import P24Twin
from igrip.errors import requires_extra

OPEN_TIMEOUT = 1.0  # s for each of the first answers


@DEVICES.register("p24")
class P24Device(Stimulator):
    """Patterns on up to eight channels, currents in steps of half a milliampere."""

    Settings = StimulatorSettings

    def __init__(self, settings: StimulatorSettings, clock: Callable[[], float]) -> None:
        super().__init__(settings, clock)
        self._device: Any = None
        self._connection: Any = None
        self._events: asyncio.AbstractEventLoop | None = None
        self._ready = False
        self._last_words: LastWords | None = None

    @staticmethod
    def new_twin(settings: DeviceSettings, clock: Callable[[], float]) -> P24Twin:
        """Return a virtual P24."""
        return P24Twin(clock)

    def open(self) -> None:
        """Connect, stop whatever runs, and read what it is."""
        with requires_extra("science-mode-4", "devices", "the P24"):
            import science_mode_4
        logging.getLogger("science_mode_4").setLevel(logging.ERROR)
        connection = science_mode_4.SerialPortConnection(
            self._settings.port, write_timeout_ins_s=WRITE_TIMEOUT, error_timeout_in_s=0.0
        )
        try:
            connection.open()
        except OSError as error:
            raise DeviceError(f"{self._settings.port}: {error}") from error
        connection._ser = Gate(connection._ser, largest4, self._settings.limit_ma, MAX_WIDTH)
        self._events = asyncio.new_event_loop()
        self._connection, self._device = connection, science_mode_4.DeviceP24(connection)
        self._last_words = LastWords(connection.ser.fileno(), encode4(Packet(0, ML_STOP, b"")))
        try:
            self._wait(self._device.initialize(), OPEN_TIMEOUT)
        except DeviceError:
            self._disconnect()
            raise

    def _stimulate(self, pulses: Sequence[Pulse]) -> None:
        import science_mode_4

        period = round(1000.0 / self._settings.frequency)
        channels: list[Any] = [None] * 8
        for pulse in pulses:
            current = int(2.0 * pulse.current) / 2.0
            points = [
                science_mode_4.ChannelPoint(pulse.width, current),
                science_mode_4.ChannelPoint(pulse.width, -current),
            ]
            channels[pulse.channel - 1] = science_mode_4.MidLevelChannelConfiguration(
                True, 0, period, points
            )
        if not self._ready:
            self._wait(self._level().init(True))
            self._ready = True
        self._wait(self._level().update(channels))

    def _halt(self) -> None:
        if self._device is not None:
            self._ready = False
            self._wait(self._level().stop())

    def keep_alive(self) -> None:
        """Ask for its state; it stimulates nothing meanwhile."""
        if self._device is None:
            raise DeviceError(f"{self._settings.port}: is not open")
        self._wait(self._device.get_layer_general().get_stim_status())

    def _level(self) -> Any:
        return self._device.get_layer_mid_level()

    def _wait(self, answer: Coroutine[Any, Any, Any], timeout: float | None = None) -> None:
        """Run the library's exchange to its end, for a bounded time."""
        assert self._events is not None
        limited = asyncio.wait_for(answer, timeout or ports.ANSWER_TIMEOUT)
        try:
            self._events.run_until_complete(limited)
        except TimeoutError as error:
            raise DeviceError(f"{self._settings.port}: the stimulator does not answer") from error
        except DeviceError:
            raise
        except Exception as error:  # it raises what its decoder stumbles over
            raise DeviceError(f"{self._settings.port}: {error}") from error

    def _disconnect(self) -> None:
        if self._last_words is not None:
            self._last_words.close()
        if self._connection is not None:
            self._connection.close()
        if self._events is not None:
            self._events.close()
        self._device = self._connection = self._events = self._last_words = None
