"""The device as a process of its own, fed by ``igrip live`` and ``igrip demo`` through a pipe.

The estimator may be busy, hang or be killed: the process that owns the device notices by the end of
the lease or of the pipe, and stops it.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence

from igrip.errors import ObservationError
from igrip.runtime.bounded_queue import BoundedQueue
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.protocol import Command, decode
from igrip.runtime.sender import Sender

CLOSE_TIMEOUT = 3.0  # s
MAX_WAITING = 64


class DeviceProcess:
    """An output of the loop: ``igrip drive --from stdin`` in a process.

    Parameters
    ----------
    arguments : sequence of str
        Of ``igrip drive``, without ``--from``.
    obey : function, optional
        Called with each command of the device's user, from a thread; by default it is submitted to
        the loop.
    """

    def __init__(
        self, arguments: Sequence[str], obey: Callable[[Command], None] | None = None
    ) -> None:
        self._arguments, self._obey = list(arguments), obey
        self._queue: BoundedQueue[Envelope] = BoundedQueue(MAX_WAITING)
        self._process: subprocess.Popen[bytes] | None = None
        self._writer = threading.Thread(target=self._write, name="igrip-device", daemon=True)
        self._reader = threading.Thread(target=self._read, name="igrip-device-in", daemon=True)
        self._sent = 0
        self._broken = False

    def start(self, loop: Loop | None = None) -> None:
        """Start the process."""
        if loop is not None and self._obey is None:
            sender = Sender(name="the device")
            self._obey = lambda command: loop.submit(command, sender)
        self._process = subprocess.Popen(
            [sys.executable, "-m", "igrip", "drive", "--from", "stdin", *self._arguments],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=_own_errors(), bufsize=0,
        )  # fmt: skip
        self._writer.start()
        self._reader.start()

    def send(self, envelope: Envelope) -> None:
        """Queue an intention; never blocks."""
        if self._broken:
            raise BrokenPipeError("igrip drive has ended")
        self._queue.put(envelope)

    def _write(self) -> None:
        assert self._process is not None
        assert self._process.stdin is not None
        while not self._queue.finished:
            envelope = self._queue.get()
            if envelope is None:
                continue
            line = envelope.to_json() + b"\n"
            try:
                while line:
                    line = line[os.write(self._process.stdin.fileno(), line) :]
            except OSError:
                self._broken = True
                return
            self._sent += 1

    def _read(self) -> None:
        assert self._process is not None
        assert self._process.stdout is not None
        for line in self._process.stdout:
            with contextlib.suppress(ObservationError):
                command = decode(line)
                if isinstance(command, Command) and self._obey is not None:
                    self._obey(command)
        self._broken = True

    def close(self) -> None:
        """End the process; it stops the device first."""
        self._queue.close()
        process = self._process
        if process is None:
            return
        self._writer.join(CLOSE_TIMEOUT)
        assert process.stdin is not None
        with contextlib.suppress(OSError):
            process.stdin.close()
        try:
            process.wait(CLOSE_TIMEOUT)
        except subprocess.TimeoutExpired:
            process.terminate()
            process.wait(CLOSE_TIMEOUT)
        self._reader.join(CLOSE_TIMEOUT)
        assert process.stdout is not None
        process.stdout.close()
        self._process = None

    def counts(self) -> dict[str, int]:
        """Return how many intentions it was sent, and how many were lost."""
        return {"sent": self._sent, "lost": self._queue.counts["dropped"]}


def _own_errors() -> int | None:
    """Return the descriptor that this program's own lines go to; libraries' go elsewhere."""
    try:
        return sys.stderr.fileno()
    except (AttributeError, OSError, ValueError):  # there is none
        return None
