"""Access control: programs of this machine may connect, and whoever has the token."""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Mapping
from urllib.parse import parse_qs, urlsplit

from igrip.errors import IgripError


def is_loopback(host: str) -> bool:
    """Whether a server on this address can be reached from this machine only."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class Access:
    """Admits or refuses requests before a connection is made.

    Any web page that is open in a browser of this machine can reach servers on loopback. The
    browser sends the page's site as ``Origin``, and foreign sites are refused without the token.

    Parameters
    ----------
    host : str
        The address the server listens on.
    token : str, optional
        Required of every client. Needed unless ``host`` is loopback.

    Raises
    ------
    IgripError
        If others can reach the server and there is no token, or it is too short.
    """

    def __init__(self, host: str, token: str | None = None) -> None:
        if token is None and not is_loopback(host):
            raise IgripError(
                f"others can reach {host}: give a token (--token or IGRIP_TOKEN), or listen on "
                "127.0.0.1"
            )
        if token is not None and len(token) < 16:
            raise IgripError("a token of fewer than 16 characters can be guessed")
        self._token = token

    def refusal(self, path: str, headers: Mapping[str, str]) -> str | None:
        """Return the reason why a request is refused; None if it is admitted."""
        if self._token is not None:
            token = headers.get("Authorization", "").removeprefix("Bearer ")
            token = token or parse_qs(urlsplit(path).query).get("token", [""])[0]
            if hmac.compare_digest(token.encode(), self._token.encode()):
                return None
            return "a token is needed: ?token=… or the header Authorization: Bearer …"
        origin = headers.get("Origin")
        if origin is None or is_loopback(urlsplit(origin).hostname or ""):
            return None
        if origin == "null":
            return (
                "a page opened from disk (Origin: null) may not connect without a token: open it "
                "from http://localhost (python -m http.server), or start igrip with --token and "
                "connect with ?token=…"
            )
        return (
            f"pages of {origin:.200} may not connect without a token: start igrip with --token and "
            "connect with ?token=…"
        )
