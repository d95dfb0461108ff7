"""A small server for pages: fixed texts, JSON, and orders by POST."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import urlsplit

from igrip.errors import IgripError
from igrip.runtime.access import Access, is_loopback

HTML, JSON = "text/html; charset=utf-8", "application/json"
SVG, PNG, JPEG = "image/svg+xml", "image/png", "image/jpeg"
MAX_BODY = 10_000  # bytes of an order
Answer = tuple[str, bytes]
"""Content type and body."""


def own_address() -> str:
    """Return the address of this machine in its network; its name where it is in none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # chooses a network; sends nothing
            return str(probe.getsockname()[0])
        except OSError:
            return socket.gethostname()


class PageServer:
    """Serves what functions return, in threads of its own.

    Parameters
    ----------
    pages : mapping of str to function
        What a GET of a path returns: content type and body.
    order : function
        Called with the path and the JSON of a POST; returns False where there is no such order. An
        :class:`igrip.errors.IgripError` is told to the page.
    port : int
        0: any that is free.
    host, token : str
        Where it listens; beyond this machine only with a token of at least 16 characters.
    find : function, optional
        What a GET of any other path returns; None: there is nothing.

    Attributes
    ----------
    url : str
        Of the page ``/``; where others may connect, as they reach this machine.
    """

    def __init__(
        self, pages: Mapping[str, Callable[[], Answer]],
        order: Callable[[str, Mapping[str, Any]], bool], port: int, host: str = "127.0.0.1",
        token: str | None = None, find: Callable[[str], Answer | None] = lambda path: None,
    ) -> None:  # fmt: skip
        access, local = Access(host, token), is_loopback(host)

        class Handler(BaseHTTPRequestHandler):
            timeout = 5.0

            def do_GET(self) -> None:
                if self._refused():
                    return
                path = urlsplit(self.path).path
                found = pages[path]() if path in pages else find(path)
                if found is None:
                    there = ", ".join(pages)
                    self._answer(HTTPStatus.NOT_FOUND, f"there are {there}\n".encode())
                else:
                    self._answer(HTTPStatus.OK, found[1], found[0])

            def do_POST(self) -> None:
                if self._refused():
                    return
                values = self._body()
                if values is None:
                    self._answer(HTTPStatus.BAD_REQUEST, b"the body is no JSON object\n")
                    return
                try:
                    known = order(urlsplit(self.path).path, values)
                except (IgripError, OSError) as error:
                    self._answer(HTTPStatus.CONFLICT, f"{error}\n".encode())
                    return
                if known:
                    self._answer(HTTPStatus.OK, b"{}\n", JSON)
                else:
                    self._answer(HTTPStatus.NOT_FOUND, b"there is no such order\n")

            def _body(self) -> Mapping[str, Any] | None:
                length = self.headers.get("Content-Length", "0")
                if not length.isdecimal() or int(length) > MAX_BODY:
                    return None
                try:
                    values = json.loads(self.rfile.read(int(length)) or b"{}")
                except (ValueError, RecursionError):
                    return None
                return values if isinstance(values, dict) else None

            def _refused(self) -> bool:
                refusal = access.refusal(self.path, dict(self.headers.items()))
                name = (self.headers.get("Host") or "").rpartition(":")[0]
                if refusal is None and local and name not in ("127.0.0.1", "localhost"):
                    refusal = "this page is for this machine"
                if refusal is not None:
                    self._answer(HTTPStatus.FORBIDDEN, refusal.encode() + b"\n")
                return refusal is not None

            def _answer(
                self, status: HTTPStatus, body: bytes, kind: str = "text/plain; charset=utf-8"
            ) -> None:
                self.send_response(status)
                self.send_header("Content-Type", kind)
                self.send_header("Content-Length", str(len(body)))
                self.send_header("Cache-Control", "no-store")
                self.send_header("Content-Security-Policy", "frame-ancestors 'none'")
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *arguments: Any) -> None:
                pass

        class Server(ThreadingHTTPServer):
            daemon_threads = True

            def handle_error(self, request: Any, client_address: Any) -> None:
                pass  # clients that vanish are no errors of ours

        self._server = Server((host, port), Handler)
        shown = "localhost" if local else own_address() if host == "0.0.0.0" else host
        self.url = f"http://{shown}:{self._server.server_address[1]}"
        threading.Thread(
            target=self._server.serve_forever, args=(0.1,), name="igrip-page", daemon=True
        ).start()

    def close(self) -> None:
        """Serve no more."""
        self._server.shutdown()
        self._server.server_close()
