"""A UDP socket that never waits, and counts."""

from __future__ import annotations

import socket
from collections import Counter

from igrip.errors import IgripError


def parse_address(text: str, option: str) -> tuple[str, int]:
    """Return host and port of ``HOST:PORT``.

    Raises
    ------
    IgripError
        If it is none.
    """
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise IgripError(f"{option} {text}: expected HOST:PORT")
    return host.strip("[]"), int(port)


class Datagrams:
    """Sends datagrams to one address.

    Attributes
    ----------
    counts : Counter
        ``sent`` and ``lost``: what the system did not take.
    """

    def __init__(self, text: str, option: str) -> None:
        host, port = parse_address(text, option)
        try:
            family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise IgripError(f"{option} {text}: {error.strerror or error}") from error
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._address = address
        self.counts: Counter[str] = Counter()

    def send(self, data: bytes) -> None:
        """Send one, or lose it."""
        try:
            self._socket.sendto(data, self._address)
            self.counts["sent"] += 1
        except OSError:  # a full buffer, no route, a message too long, nobody there
            self.counts["lost"] += 1

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
