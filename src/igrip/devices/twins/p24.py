"""A virtual P24: the part of ScienceMode 4 that the mid level needs, and its time-out of 2 s."""

from __future__ import annotations

from collections.abc import Callable

from igrip.devices.base.sciencemode import (
    ML_CURRENT_DATA,
    ML_INIT,
    ML_STOP,
    ML_UPDATE,
    Frames,
    Packet,
    decode4,
    encode4,
    points4,
)  # fmt: skip
from igrip.devices.base.twin import OutputLog

TIMEOUT = 2.0  # s without a command of the mid level after which it stops
DEVICE_ID, STIM_STATUS, VERSION, UNKNOWN = 52, 62, 68, 67
PARAMETER_ERROR, NOT_INITIALIZED = 2, 7


class P24Twin(OutputLog):
    """Stimulates on eight channels as the mid level tells it.

    Attributes
    ----------
    pulses : list of (int, float, int)
        Channel, current [mA] and width [µs] of each point now.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        super().__init__(clock)
        self._frames = Frames()
        self._level = 0  # 0: not initialised, 2: initialised, 3: running
        self._heard = clock()
        self.pulses: list[tuple[int, float, int]] = []

    def receive(self, data: bytes) -> bytes:
        """Answer each whole packet."""
        reply = self.tick()
        for whole in self._frames.feed(data):
            packet = decode4(whole)
            if packet is not None:
                reply += self._answer(packet)
        return reply

    def _answer(self, packet: Packet) -> bytes:
        data = b"\0"
        if packet.command == DEVICE_ID:
            data += b"TWIN000000"
        elif packet.command == VERSION:
            data += bytes((1, 0, 0, 4, 0, 0)) + bytes(4) + bytes((0, 1))
        elif packet.command == STIM_STATUS:
            data += bytes((self._level, 6 if self._level else 0))
        elif packet.command in (ML_INIT, ML_UPDATE, ML_STOP, ML_CURRENT_DATA):
            self._heard = self.clock()
            data = self._mid_level(packet)
        else:
            return encode4(Packet(packet.number, UNKNOWN, b"\x0b"))
        return encode4(Packet(packet.number, packet.command + 1, data))

    def _mid_level(self, packet: Packet) -> bytes:
        if packet.command == ML_INIT:
            self._level = 2
            self._rest()
        elif packet.command == ML_STOP:
            self._level = 0
            self._rest()
        elif self._level == 0:
            return bytes((NOT_INITIALIZED,))
        elif packet.command == ML_UPDATE:
            try:
                self.pulses = points4(packet.data)
            except IndexError:
                return bytes((PARAMETER_ERROR,))
            self._level = 3
            strongest = max((abs(current) for _, current, _ in self.pulses), default=0.0)
            text = ", ".join(f"{c}: {i:g} mA {w} µs" for c, i, w in self.pulses if i > 0)
            self.note(strongest > 0, strongest, text)
        else:
            active = sum(1 << channel - 1 for channel in {c for c, _, _ in self.pulses})
            return bytes((0, 4, active)) + bytes(4)
        return b"\0"

    def _rest(self) -> None:
        self.pulses = []
        self.note(False)

    def tick(self) -> bytes:
        """Stop where the mid level has not been heard for long."""
        if self._level and self.clock() - self._heard > TIMEOUT:
            self._level = 0
            self._rest()
        return b""
