"""Addresses of receivers, as ``host:port``."""

from __future__ import annotations

import socket
from contextlib import suppress
from typing import Any

from igrip.errors import IgripError


class DatagramSocket:
    """Sends datagrams to one address, and never waits.

    Attributes
    ----------
    sent, lost : int
        Datagrams. UDP does not say what arrives: lost are those that could not be sent.

    Raises
    ------
    IgripError
        If the address is none.
    """

    def __init__(self, address: str, option: str) -> None:
        host, port = parse_address(address, option)
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise IgripError(f"{option} {address}: {error.strerror or error}") from error
        family, kind, protocol, _, to = found
        self._to: tuple[Any, ...] = to
        self._socket = socket.socket(family, kind, protocol)
        self._socket.setblocking(False)
        self.sent = self.lost = 0

    def send(self, data: bytes) -> None:
        """Send a datagram, or lose it."""
        try:
            self._socket.sendto(data, self._to)
        except OSError:  # no buffer is free, it is too large, or no route leads there
            self.lost += 1
        else:
            self.sent += 1

    def counts(self) -> dict[str, int]:
        """Return how many were sent and lost."""
        return {"sent": self.sent, "lost": self.lost}

    def close(self) -> None:
        """Close the socket; may be called twice."""
        with suppress(OSError):
            self._socket.close()


def parse_address(address: str, option: str) -> tuple[str, int]:
    """Return host and port of ``host:port``; a host of IPv6 stands in brackets.

    Raises
    ------
    IgripError
        If it is not of that form.
    """
    host, _, port = address.rpartition(":")
    number: Any = int(port) if port.isascii() and port.isdigit() else None
    if not host or number is None or not 0 < number < 65_536:
        raise IgripError(f"{option} {address}: must be HOST:PORT, such as 127.0.0.1:9870")
    return host.strip("[]"), number
