"""Where a device's messages come from: standard input, or the WebSocket of ``igrip stream``."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable
from typing import Any

import msgspec

from igrip.drive.loop import DriveLoop
from igrip.errors import IgripError, requires_extra

MAX_LINE = 1 << 18  # bytes
RETRY = 0.5  # s


class StdinSource:
    """Lines of JSON on standard input; commands to the estimator go to standard output.

    The other end is a process of this machine (``igrip live --device``), with the same clock.
    """

    same_clock = True

    def __init__(self, input_fd: int = 0, output_fd: int = 1) -> None:
        self._input, self._output = input_fd, output_fd

    def start(self, loop: DriveLoop) -> None:
        """Begin to read; the end of the input ends the loop."""
        self._loop = loop
        threading.Thread(target=self._run, name="igrip-drive-stdin", daemon=True).start()

    def _run(self) -> None:
        rest = b""
        with contextlib.suppress(OSError):
            while data := os.read(self._input, 65536):
                *lines, rest = (rest + data).split(b"\n")
                if len(rest) > MAX_LINE:
                    rest = b""
                for line in lines:
                    self._loop.submit(decoded(line))
        self._loop.order("end")

    def say(self, command: dict[str, Any]) -> None:
        """Send a command."""
        with contextlib.suppress(OSError):
            os.write(self._output, msgspec.json.encode(command) + b"\n")

    def close(self) -> None:
        """Nothing: the thread ends with the input."""


class WebSocketSource:
    """Intentions of a service, as JSON text; it connects again when the connection ends.

    Parameters
    ----------
    url : str
        ``ws://HOST:PORT``, with ``?token=…`` if one is needed.
    warn : function
        Called with each new reason why there is no connection.
    """

    def __init__(
        self, url: str, same_clock: bool = False, warn: Callable[[str], None] = lambda text: None
    ) -> None:
        with requires_extra("websockets", "outputs", "a device that listens to igrip stream"):
            import websockets.sync.client as client
        self._connect = client.connect
        base, mark, query = url.partition("?")
        if not base.startswith(("ws://", "wss://")):
            raise IgripError(f"--from {url}: expected stdin or ws://HOST:PORT")
        path = "" if base.rstrip("/").endswith("/intentions") else "/intentions"
        self._url = f"{base.rstrip('/')}{path}{mark}{query}"
        self.same_clock, self._warn = same_clock, warn
        self._connection: Any = None
        self._closed = threading.Event()

    def start(self, loop: DriveLoop) -> None:
        """Begin to connect."""
        self._loop = loop
        threading.Thread(target=self._run, name="igrip-drive-ws", daemon=True).start()

    def _run(self) -> None:
        reason = ""
        while not self._closed.is_set():
            try:
                with self._connect(
                    self._url, open_timeout=3.0, close_timeout=0.5, compression=None,
                    max_size=MAX_LINE, ping_interval=5.0, ping_timeout=5.0, proxy=None,
                ) as connection:  # fmt: skip
                    self._connection, reason = connection, ""
                    for data in connection:
                        self._loop.submit(decoded(data))
            except Exception as error:  # whatever ends a connection, another one is tried
                if str(error) != reason:
                    reason = str(error)
                    self._warn(f"{self._url}: {reason}")
            self._connection = None
            self._loop.order("lost")
            self._closed.wait(RETRY)

    def say(self, command: dict[str, Any]) -> None:
        """Send a command, if there is a connection."""
        connection = self._connection
        if connection is not None:
            with contextlib.suppress(Exception):  # it has just ended: the lease ends with it
                connection.send(msgspec.json.encode(command).decode())

    def close(self) -> None:
        """Disconnect."""
        self._closed.set()
        connection = self._connection
        if connection is not None:
            with contextlib.suppress(Exception):  # as above
                connection.close()


def decoded(data: bytes | str) -> Any:
    """Return a message as plain data; None if it is not JSON."""
    try:
        return msgspec.json.decode(data)
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return None


def open_source(
    text: str, same_clock: bool, warn: Callable[[str], None]
) -> StdinSource | WebSocketSource:
    """Return the source that ``--from`` names."""
    return StdinSource() if text == "stdin" else WebSocketSource(text, same_clock, warn)
