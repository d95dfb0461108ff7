"""The emulator of the firmware that nml-hand-exo brings for its own tests, at the end of a wire."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from igrip.devices.base.twin import OutputLog
from igrip.errors import requires_extra

MAX_LINE = 256


class NmlHandExoTwin(OutputLog):
    """Answers lines as the firmware does; a reply ends with a semicolon.

    Attributes
    ----------
    firmware : FakeOpenRBComm
        The package's emulator.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        super().__init__(clock)
        with requires_extra("nml-hand-exo", "nml-hand-exo", "the twin of the NML hand exoskeleton"):
            from nml_hand_exo.testing.fake_openrb import FakeOpenRBComm
        self.firmware: Any = FakeOpenRBComm()
        self.firmware.connect()
        self._line = b""

    def receive(self, data: bytes) -> bytes:
        """Answer each whole line."""
        reply = b""
        *lines, self._line = (self._line + data).split(b"\n")
        self._line = self._line[:MAX_LINE]
        for line in lines:
            try:
                self.firmware.send(line[:MAX_LINE].decode("ascii", errors="replace"))
                answer = self.firmware.receive()
            except (ValueError, KeyError, IndexError) as error:
                answer = f"ERROR: {error!r}"
            reply += answer.replace(";", ",").encode() + b";\n"
            if line.strip() in (b"disable:all", b"stop:all"):
                self.firmware.holds.clear()
        holds = self.firmware.holds.values()
        strongest = max((float(hold["current_mA"]) for hold in holds), default=0.0)
        self.note(bool(holds), strongest, f"{len(holds)} motors held" if holds else "")
        return reply

    def tick(self) -> bytes:
        """Nothing: a hold has no end of its own."""
        return b""
