"""A virtual RehaStim 2: ScienceMode 2, its state machine and its watchdog of 2 s.

After "ScienceMode2: description and protocol" (Hasomed, 2012), as pysciencemode cites it.
"""

from __future__ import annotations

from collections.abc import Callable

from igrip.devices.base.sciencemode import (
    INIT,
    INIT_ACK,
    SET_UP,
    START_STIMULATION,
    STOP_STIMULATION,
    Frames,
    Packet,
    decode2,
    encode2,
)  # fmt: skip
from igrip.devices.base.twin import OutputLog

WATCHDOG = 2.0  # s without a packet after which it stops and forgets the program
INTRODUCTION = 0.2  # s between two packets by which it introduces itself
PARAMETER_ERROR, WRONG_MODE = 0xFE, 0xFD


class Rehastim2Twin(OutputLog):
    """Stimulates on eight channels as it is told.

    Attributes
    ----------
    pulses : list of (int, float, int)
        Channel, current [mA] and width [µs] now.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        super().__init__(clock)
        self._frames = Frames()
        self._known = False
        self._heard = clock()
        self._introduced = -1e9
        self._channels: list[int] | None = None
        self._number = 0
        self.pulses: list[tuple[int, float, int]] = []

    def receive(self, data: bytes) -> bytes:
        """Answer each whole packet."""
        reply = self.tick()
        for whole in self._frames.feed(data):
            packet = decode2(whole)
            if packet is None:
                continue
            self._heard = self.clock()
            if packet.command == INIT_ACK:
                self._known = True
            elif self._known:
                reply += self._answer(packet)
        return reply

    def _answer(self, packet: Packet) -> bytes:
        result = 0
        if packet.command == SET_UP:
            if len(packet.data) < 2:
                result = PARAMETER_ERROR
            else:
                self._channels = [k + 1 for k in range(8) if packet.data[1] >> k & 1]
                self._rest()
        elif packet.command == START_STIMULATION:
            if self._channels is None:
                result = WRONG_MODE
            elif len(packet.data) != 4 * len(self._channels):
                result = PARAMETER_ERROR
            else:
                self._pulse(packet.data)
        elif packet.command == STOP_STIMULATION:
            self._channels = None
            self._rest()
        else:
            return b""
        return self._send(packet.command + 1, bytes((result,)))

    def _pulse(self, data: bytes) -> None:
        assert self._channels is not None
        self.pulses = [
            (channel, float(data[4 * k + 3]), data[4 * k + 1] << 8 | data[4 * k + 2])
            for k, channel in enumerate(self._channels)
        ]
        strongest = max(current for _, current, _ in self.pulses)
        text = ", ".join(f"{c}: {i:g} mA {w} µs" for c, i, w in self.pulses if i > 0)
        self.note(strongest > 0, strongest, text)

    def _rest(self) -> None:
        self.pulses = []
        self.note(False)

    def tick(self) -> bytes:
        """Introduce itself until it is answered; stop where nobody is heard any more."""
        now = self.clock()
        if self._known and now - self._heard > WATCHDOG:
            self._known, self._channels = False, None
            self._rest()
        if self._known or now - self._introduced < INTRODUCTION:
            return b""
        self._introduced = now
        return self._send(INIT, b"\x01")

    def _send(self, command: int, data: bytes) -> bytes:
        self._number += 1
        return encode2(Packet(self._number, command, data))
