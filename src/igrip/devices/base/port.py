"""Serial ports, opened exclusively and with bounded waits; and the last words of a killed process.

If the process that owns a port is killed, nobody sends the command to stop. A small process that
holds the same descriptor waits for that, and writes it.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from typing import TYPE_CHECKING

from igrip.devices.base.device import DeviceError
from igrip.errors import requires_extra

if TYPE_CHECKING:
    import serial

WRITE_TIMEOUT = 0.03  # s
ANSWER_TIMEOUT = 0.05  # s that a device may take to answer

# reads from a pipe that its parent holds open; the end of it is the end of the parent
_LAST_WORDS = """
import os, signal, sys
for name in ("SIGINT", "SIGTERM", "SIGHUP"):
    signal.signal(getattr(signal, name), signal.SIG_IGN)
pipe, port, words = int(sys.argv[1]), int(sys.argv[2]), bytes.fromhex(sys.argv[3])
said = b""
while part := os.read(pipe, 64):
    said += part
if not said.endswith(b"."):
    for _ in range(3):
        os.write(port, words)
"""


def open_serial(port: str, baudrate: int) -> serial.Serial:
    """Open a port that no other program has open.

    Raises
    ------
    DeviceError
        If it is not there, in use, or not permitted.
    """
    with requires_extra("pyserial", "devices", "a device on a serial port"):
        import serial
    try:
        return serial.Serial(
            port, baudrate, timeout=0.0, write_timeout=WRITE_TIMEOUT, exclusive=True
        )
    except (serial.SerialException, ValueError, OSError) as error:
        raise DeviceError(f"{port}: {error}") from error


class LastWords:
    """Writes bytes to an open port when this process dies, however it dies.

    Parameters
    ----------
    descriptor : int
        Of the port.
    words : bytes
        The command to stop.
    """

    def __init__(self, descriptor: int, words: bytes) -> None:
        read, self._write = os.pipe()
        command = [sys.executable, "-I", "-S", "-c", _LAST_WORDS]
        self._process = subprocess.Popen(
            [*command, str(read), str(descriptor), words.hex()], pass_fds=(read, descriptor),
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True,
        )  # fmt: skip
        os.close(read)

    def close(self) -> None:
        """End without a word: the port is closed in good order."""
        if self._write < 0:
            return
        with contextlib.suppress(OSError):  # it has ended already
            os.write(self._write, b".")
        os.close(self._write)
        self._write = -1
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=2.0)
