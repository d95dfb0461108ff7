"""``rehastim2``: Hasomed's RehaStim 2, through pysciencemode (S2M, Université de Montréal).

pysciencemode keeps the stimulator alive by a thread of its own, whatever becomes of the program's
decisions, and waits for answers without end. Here that thread is never started: each packet follows
from a fresh decision, and without one the stimulator's own watchdog (2 s) is the last resort.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from igrip.devices import DEVICES
from igrip.devices.base import port as ports
from igrip.devices.base import sciencemode
from igrip.devices.base.device import DeviceError
from igrip.devices.base.gate import Gate
from igrip.devices.base.limits import MAX_WIDTH
from igrip.devices.base.port import LastWords
from igrip.devices.base.sciencemode import STOP_STIMULATION, Packet, decode2, encode2, largest2
from igrip.devices.base.settings import DeviceSettings, StimulatorSettings
from igrip.devices.base.stimulator import Pulse, Stimulator
from igrip.devices.twins.rehastim2 import Rehastim2Twin
from igrip.errors import requires_extra

OPEN_TIMEOUT = 3.0  # s until the stimulator introduces itself


@DEVICES.register("rehastim2")
class Rehastim2Device(Stimulator):
    """Patterns on up to eight channels; currents are whole milliamperes, rounded down."""

    Settings = StimulatorSettings

    def __init__(self, settings: StimulatorSettings, clock: Callable[[], float]) -> None:
        super().__init__(settings, clock)
        self._library: Any = None
        self._ready = False
        self._last_words: LastWords | None = None

    @staticmethod
    def new_twin(settings: DeviceSettings, clock: Callable[[], float]) -> Rehastim2Twin:
        """Return a virtual RehaStim 2."""
        return Rehastim2Twin(clock)

    def open(self) -> None:
        """Connect and introduce this program; nothing is stimulated."""
        with requires_extra("pysciencemode", "devices", "the RehaStim 2"):
            import pysciencemode
            import serial
        quiet = _quiet(pysciencemode.Rehastim2, self._settings.limit_ma)
        try:
            self._library = quiet(self._settings.port)
        except (serial.SerialException, OSError) as error:
            raise DeviceError(f"{self._settings.port}: {error}") from error
        self._last_words = LastWords(
            self._library.port.fileno(), encode2(Packet(0, STOP_STIMULATION, b""))
        )

    def _stimulate(self, pulses: Sequence[Pulse]) -> None:
        import pysciencemode

        given = {pulse.channel: pulse for pulse in pulses}
        widths = {
            channel.number: channel.width_us for pattern in self._settings.grips.values()
            for channel in (*pattern.reach, *pattern.grasp)
        }  # fmt: skip
        channels = []
        for number in self._settings.numbers():  # all of them: those of no pulse get no current
            pulse = given.get(number, Pulse(number, 0.0, widths[number]))
            channels.append(pysciencemode.Channel(
                "Single", number, int(pulse.current), pulse.width, device_type="Rehastim2"
            ))  # fmt: skip
        if not self._ready:
            interval = max(8, round(1000.0 / self._settings.frequency))
            self._do(lambda library: library.init_channel(interval, channels))
            self._ready = True
        self._do(lambda library: library.start_stimulation(upd_list_channels=channels))

    def _halt(self) -> None:
        if self._library is not None:
            self._ready = False
            self._do(lambda library: library.end_stimulation())

    def keep_alive(self) -> None:
        """Send its watchdog; it stimulates nothing meanwhile."""
        self._do(
            lambda library: library.send_generic_packet("Watchdog", library._packet_watchdog())
        )

    def _do(self, what: Callable[[Any], object]) -> None:
        if self._library is None:
            raise DeviceError(f"{self._settings.port}: is not open")
        try:
            what(self._library)
        except (OSError, RuntimeError, ValueError, TypeError) as error:
            raise DeviceError(f"{self._settings.port}: {error}") from error

    def _disconnect(self) -> None:
        if self._last_words is not None:
            self._last_words.close()
        if self._library is not None:
            self._library.close_port()
        self._library = self._last_words = None


def _quiet(base: type[Any], limit: float) -> type[Any]:
    """Return the library's class without its threads, with bounded waits and a gate."""

    class Quiet(base):  # type: ignore[misc]
        port: Any

        def _start_watchdog(self) -> None:
            self.port = Gate(self.port, largest2, limit, MAX_WIDTH)

        def _start_thread_catch_ack(self) -> None:
            pass

        def _read_packet(self) -> list[bytes]:
            """Return whole packets, unstuffed where the library expects plain bytes."""
            frames = self.__dict__.setdefault("_frames", sciencemode.Frames())
            packets = [
                decode2(whole) for whole in frames.feed(self.port.read(self.port.in_waiting))
            ]
            return [
                b"\xf0\x81\0\x81\0" + bytes((p.number, p.command)) + p.data + b"\x0f"
                for p in packets if p is not None
            ]  # fmt: skip

        def _get_last_ack(self, init: bool = False) -> bytes:
            end = time.monotonic() + (OPEN_TIMEOUT if init else ports.ANSWER_TIMEOUT)
            while time.monotonic() < end:
                for packet in self._read_packet():
                    command, result = packet[6], packet[7:8]
                    if command == sciencemode.INIT:  # it introduces itself, unasked
                        if init:
                            return packet
                    elif command == sciencemode.STIMULATION_ERROR or result != b"\0":
                        raise DeviceError(f"the stimulator refuses: {self._calling_ack(packet)}")
                    else:
                        return packet
                time.sleep(0.0005)
            raise DeviceError("the stimulator does not answer")

    return Quiet
