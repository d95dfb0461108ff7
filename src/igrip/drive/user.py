"""The user's say: a key, a serial line, an LSL marker or muscle activity that vetoes or confirms.

``key:v``, ``serial:/dev/ttyACM0``, ``marker:STREAM=TEXT`` and ``emg:STREAM/CHANNEL>VALUE`` (root
mean square over 100 ms, in the unit of the stream). A foot switch that types a letter is a key.
"""

from __future__ import annotations

import contextlib
import math
import os
import re
import select
import sys
import termios
import threading
import tty
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from typing import Any

from igrip.errors import IgripError, requires_extra

EMG_WINDOW = 0.1  # s
REFRACTORY = 0.5  # s in which one signal counts once
POLL = 0.05  # s
FORMS = "key:v, serial:/dev/ttyACM0, marker:STREAM=TEXT or emg:STREAM/CHANNEL>VALUE"


class Signal(ABC):
    """Watches something in a thread, and calls a function when it happens."""

    def __init__(self) -> None:
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, act: Callable[[], None], warn: Callable[[str], None]) -> None:
        """Begin to watch."""
        self._thread = threading.Thread(
            target=self._guarded, args=(act, warn), name="igrip-user", daemon=True
        )
        self._thread.start()

    def _guarded(self, act: Callable[[], None], warn: Callable[[str], None]) -> None:
        """Veto is the safe side: a signal that is lost is reported, and counts as given once."""
        try:
            self.watch(act)
        except Exception as error:  # whatever its library raises
            if not self._closed.is_set():
                warn(f"{self}: {error}; it is not watched any more")
                if self.on_loss:
                    act()

    on_loss = False

    @abstractmethod
    def watch(self, act: Callable[[], None]) -> None:
        """Watch until it is closed."""

    def close(self) -> None:
        """Watch no more."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join(timeout=1.0)


class Keys:
    """The keyboard of the terminal, for all keys together."""

    def __init__(self, keys: dict[str, Callable[[], None]]) -> None:
        self._keys = keys
        self._terminal: int | None = None
        self._before: list[Any] | None = None
        self._closed = threading.Event()

    def start(self) -> bool:
        """Begin to read keys; False: there is no terminal."""
        try:
            self._terminal = os.open("/dev/tty", os.O_RDONLY)
            self._before = termios.tcgetattr(self._terminal)
            tty.setcbreak(self._terminal)
        except (OSError, termios.error):
            return False
        threading.Thread(target=self._run, name="igrip-keys", daemon=True).start()
        return True

    def _run(self) -> None:
        assert self._terminal is not None
        while not self._closed.is_set():
            if select.select([self._terminal], [], [], POLL)[0]:
                for key in os.read(self._terminal, 64).decode(errors="ignore"):
                    self._keys.get(key, lambda: None)()

    def close(self) -> None:
        """Give the terminal back as it was."""
        self._closed.set()
        if self._terminal is not None and self._before is not None:
            with contextlib.suppress(termios.error):
                termios.tcsetattr(self._terminal, termios.TCSADRAIN, self._before)


class SerialLine(Signal):
    """Any byte on a serial port, such as a button's."""

    on_loss = True

    def __init__(self, port: str, baudrate: int = 9600) -> None:
        super().__init__()
        with requires_extra("pyserial", "devices", "a switch on a serial port"):
            import serial
        try:
            self._port = serial.Serial(port, baudrate, timeout=POLL)
        except (serial.SerialException, OSError) as error:
            raise IgripError(f"{port}: {error}") from error
        self._name = port

    def __str__(self) -> str:
        return self._name

    def watch(self, act: Callable[[], None]) -> None:
        """Act on each burst of bytes."""
        while not self._closed.is_set():
            if self._port.read(1):
                act()
                self._closed.wait(POLL)
                self._port.reset_input_buffer()

    def close(self) -> None:
        """Close the port."""
        super().close()
        self._port.close()


class Marker(Signal):
    """A text on a marker stream of the Lab Streaming Layer."""

    def __init__(self, stream: str, text: str) -> None:
        super().__init__()
        self._stream, self._text = stream, text
        self._lsl = _pylsl()

    def __str__(self) -> str:
        return f"LSL stream {self._stream!r}"

    def watch(self, act: Callable[[], None]) -> None:
        """Act on each marker with this text."""
        inlet = _inlet(self._lsl, self._stream, self._closed)
        while inlet is not None and not self._closed.is_set():
            sample, _ = inlet.pull_sample(timeout=POLL)
            if sample and str(sample[0]).strip() == self._text:
                act()


class Emg(Signal):
    """Muscle activity above a threshold, on a signal of the Lab Streaming Layer."""

    def __init__(self, stream: str, channel: int, threshold: float) -> None:
        super().__init__()
        self._stream, self._channel, self._threshold = stream, channel, threshold
        self._lsl = _pylsl()

    def __str__(self) -> str:
        return f"LSL stream {self._stream!r}"

    def watch(self, act: Callable[[], None]) -> None:
        """Act each time the root mean square of a window crosses the threshold upwards."""
        inlet = _inlet(self._lsl, self._stream, self._closed)
        meter: RmsMeter | None = None
        while inlet is not None and not self._closed.is_set():
            samples, times = inlet.pull_chunk(timeout=POLL)
            meter = meter or RmsMeter(self._threshold)
            for sample, t in zip(samples, times, strict=True):
                if self._channel < len(sample) and meter.add(sample[self._channel], t):
                    act()


class RmsMeter:
    """Finds where the root mean square of a signal crosses a threshold upwards.

    Parameters
    ----------
    threshold : float
        In the unit of the signal.
    """

    def __init__(self, threshold: float) -> None:
        self._threshold = threshold
        self._window: deque[tuple[float, float]] = deque()
        self._sum = 0.0
        self._above = False
        self._acted = -math.inf

    def add(self, value: float, t: float) -> bool:
        """Add a sample, taken at ``t`` [s]; return whether it crosses."""
        if not math.isfinite(value):
            return False
        self._window.append((t, value * value))
        while self._window and t - self._window[0][0] > EMG_WINDOW:
            self._window.popleft()
        mean = math.fsum(square for _, square in self._window) / len(self._window)
        was, self._above = self._above, math.sqrt(mean) > self._threshold
        if was or not self._above or t - self._acted < REFRACTORY:
            return False
        self._acted = t
        return True


def parse_signal(text: str) -> str | Signal:
    """Return what a text names: one letter for a key, or a signal to be watched.

    Raises
    ------
    IgripError
        If it names nothing.
    """
    kind, _, rest = text.partition(":")
    if kind == "key" and len(rest) == 1:
        return rest
    if kind == "serial" and rest:
        return SerialLine(rest)
    if kind == "marker" and (found := re.fullmatch(r"(.+)=(.+)", rest)):
        return Marker(found[1], found[2])
    if kind == "emg" and (found := re.fullmatch(r"(.+)/(\d+)>([0-9.eE+-]+)", rest)):
        with contextlib.suppress(ValueError):
            return Emg(found[1], int(found[2]), float(found[3]))
    raise IgripError(f"{text}: expected {FORMS}")


def _pylsl() -> Any:
    with requires_extra("pylsl", "outputs", "a signal of the Lab Streaming Layer", (
        ImportError, RuntimeError,
    )):  # fmt: skip
        import pylsl
    return pylsl


def _inlet(lsl: Any, stream: str, closed: threading.Event) -> Any:
    while not closed.is_set():
        found = lsl.resolve_byprop("name", stream, timeout=1.0)
        if found:
            return lsl.StreamInlet(found[0], max_buflen=2)
    return None


def has_terminal() -> bool:
    """Whether a user sits at a terminal."""
    return sys.stderr.isatty()
