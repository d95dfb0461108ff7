"""The page of a device: hand, target, time left of the lease, state, and a big stop."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from typing import Any, get_args

from igrip.drive.loop import DriveLoop, Order
from igrip.runtime.access import Access

ORDERS = frozenset(get_args(Order)) - {"lost", "end"}


class DevicePage:
    """Serves the page; ``/status`` is JSON, and a POST to ``/stop`` (or another order) is obeyed.

    Parameters
    ----------
    loop : DriveLoop
        Of the device.
    port : int
        On this machine only; 0: any that is free.
    extra : function
        Returns what else the page shows, such as the device's name.
    """

    def __init__(
        self, loop: DriveLoop, port: int, extra: Callable[[], dict[str, Any]] = dict
    ) -> None:
        access = Access("127.0.0.1")
        html = resources.files("igrip.drive").joinpath("page.html").read_bytes()

        class Handler(BaseHTTPRequestHandler):
            timeout = 5.0

            def do_GET(self) -> None:
                if not self._refused():
                    if self.path == "/status":
                        body = json.dumps(loop.status() | extra()).encode()
                        self._answer(HTTPStatus.OK, body, "application/json")
                    elif self.path == "/":
                        self._answer(HTTPStatus.OK, html, "text/html; charset=utf-8")
                    else:
                        self._answer(HTTPStatus.NOT_FOUND, b"there are / and /status\n")

            def do_POST(self) -> None:
                if not self._refused():
                    order = self.path.removeprefix("/")
                    if order in ORDERS:
                        loop.order(order)  # type: ignore[arg-type]
                        self._answer(HTTPStatus.OK, b"{}\n", "application/json")
                    else:
                        self._answer(HTTPStatus.NOT_FOUND, b"there is no such order\n")

            def _refused(self) -> bool:
                refusal = access.refusal(self.path, dict(self.headers.items()))
                host = (self.headers.get("Host") or "").rpartition(":")[0]
                if refusal is None and host not in ("127.0.0.1", "localhost"):
                    refusal = "this page is for this machine"
                if refusal is not None:
                    self._answer(HTTPStatus.FORBIDDEN, refusal.encode() + b"\n")
                return refusal is not None

            def _answer(self, status: HTTPStatus, body: bytes, kind: str = "text/plain") -> None:
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

        self._server = Server(("127.0.0.1", port), Handler)
        self.url = f"http://localhost:{self._server.server_address[1]}"
        threading.Thread(
            target=self._server.serve_forever, args=(0.1,), name="igrip-page", daemon=True
        ).start()

    def close(self) -> None:
        """Serve no more."""
        self._server.shutdown()
        self._server.server_close()
