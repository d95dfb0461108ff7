"""Virtual twins of devices: they speak the wire protocol and show what the device would do."""

from __future__ import annotations

import contextlib
import errno
import os
import select
import termios
import threading
import tty
from collections.abc import Callable
from typing import NamedTuple, Protocol


class Output(NamedTuple):
    """What a twin does at a time."""

    t: float  # on the twin's clock [s]
    active: bool  # whether it stimulates or moves
    current: float  # the largest, in mA; 0 where that has no meaning
    text: str


class Twin(Protocol):
    """A device without hardware. ``receive`` and ``tick`` are its whole wire.

    Attributes
    ----------
    outputs : list of Output
        Every change of what it does, oldest first.
    """

    outputs: list[Output]

    def receive(self, data: bytes) -> bytes:
        """Return the reply to what was written to its port."""

    def tick(self) -> bytes:
        """Let its own timers run; return what it sends of its own accord."""


class OutputLog:
    """Base of twins: remembers changes of output, within a bound."""

    MAX = 1_000_000

    def __init__(self, clock: Callable[[], float]) -> None:
        self.clock = clock
        self.outputs: list[Output] = []

    def note(self, active: bool, current: float = 0.0, text: str = "") -> None:
        """Remember what it does from now on, if that is something else than before."""
        last = self.outputs[-1] if self.outputs else Output(0.0, False, 0.0, "")
        if (active, current, text) != (last.active, last.current, last.text):
            if len(self.outputs) >= self.MAX:
                del self.outputs[: self.MAX // 2]
            self.outputs.append(Output(self.clock(), active, current, text))

    @property
    def active(self) -> bool:
        """Whether it acts now."""
        return bool(self.outputs) and self.outputs[-1].active


class PtyServer:
    """Serves a twin on a pseudo-terminal, in a thread; ``path`` is what a program opens."""

    INTERVAL = 0.002  # s

    def __init__(self, twin: Twin) -> None:
        self.twin = twin
        self._main, self._side = os.openpty()
        tty.setraw(self._side)
        attributes = termios.tcgetattr(self._side)
        attributes[3] &= ~termios.ECHO
        termios.tcsetattr(self._side, termios.TCSANOW, attributes)
        self.path = os.ttyname(self._side)
        os.set_blocking(self._main, False)
        self._stopped = threading.Event()
        self.pulled = False  # whether the cable is pulled: nothing goes in or out
        self._thread = threading.Thread(target=self._run, name="igrip-twin", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while not self._stopped.is_set():
            ready, _, _ = select.select([self._main], [], [], self.INTERVAL)
            data = b""
            if ready:
                try:
                    data = os.read(self._main, 4096)
                except OSError as error:
                    if error.errno not in (errno.EIO, errno.EAGAIN):
                        return
                    self._stopped.wait(self.INTERVAL)
            if self.pulled:
                data = b""
            reply = (self.twin.receive(data) if data else b"") + self.twin.tick()
            if reply and not self.pulled:
                with contextlib.suppress(OSError):  # its reader is too slow, or gone
                    os.write(self._main, reply)

    def close(self) -> None:
        """End the thread and the terminal; whoever has it open gets an error."""
        if self._stopped.is_set():
            return
        self._stopped.set()
        self._thread.join(timeout=2.0)
        for descriptor in (self._main, self._side):
            with contextlib.suppress(OSError):
                os.close(descriptor)
