"""The server of the page: its files over HTTP, and what it shows over a WebSocket."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import mimetypes
import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from typing import Any
from urllib.parse import unquote, urlsplit

import msgspec

from igrip.errors import IgripError, requires_extra
from igrip.runtime.access import Access, is_loopback

with requires_extra("websockets", "viewer", "the page in the browser"):
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.datastructures import Headers
    from websockets.exceptions import ConnectionClosed
    from websockets.http11 import Request, Response

STATIC = files("igrip.viewer") / "static"
TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript",
         ".svg": "image/svg+xml"}  # fmt: skip
POLICY = (  # the page loads nothing from elsewhere, and runs no script but its own
    "default-src 'self'; img-src 'self' blob: data:; media-src 'self' blob:; "
    "connect-src 'self' ws: wss:; style-src 'self'; frame-ancestors 'none'"
)
MAX_ROWS = 100_000  # kept for pages that are opened later
CHUNK = 2000  # rows in a message
MAX_MESSAGE = 4096  # bytes from a page

log = logging.getLogger("igrip.page")
log.addHandler(logging.NullHandler())
log.propagate = False  # a browser that goes away is no error of ours


class _Client:
    """One open page: the kinds of message that wait for it, and the next row it needs."""

    def __init__(self) -> None:
        self.waiting: dict[str, str] = {}
        self.row = 0
        self.reset = True
        self.news = asyncio.Event()


class PageServer:
    """Serves the page, in a thread of its own.

    Of each kind of message a page gets the newest; of rows it gets all.

    Parameters
    ----------
    host, port : str, int
        Address to listen on; port 0: any that is free.
    on_message : function
        Called, in the server's thread, with each message of a page that is a JSON object.

    Raises
    ------
    IgripError
        If the port is not free, or others could reach the address.
    """

    def __init__(
        self, host: str, port: int, on_message: Callable[[dict[str, Any]], None] = lambda _: None
    ) -> None:
        self._access = Access(host)
        self._host, self.port, self._on_message = host, port, on_message
        self._kept: dict[str, str] = {}
        self._rows: deque[bytes] = deque(maxlen=MAX_ROWS)
        self._count = 0  # of rows since the last reset
        self._clients: set[_Client] = set()
        self._resources: dict[str, tuple[str, bytes]] = {}
        self._stop = asyncio.Event()
        self._ready = threading.Event()
        self._error: OSError | None = None
        self._events: asyncio.AbstractEventLoop | None = None
        self._thread = threading.Thread(target=self._run, name="igrip-page", daemon=True)
        self._thread.start()
        self._ready.wait()
        if self._error is not None:
            raise IgripError(f"cannot listen on {host}:{port}: {self._error.strerror}")

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://localhost:{self.port}"

    def publish(self, kind: str, message: Mapping[str, Any], key: str | None = None) -> None:
        """Send a message to every page, now and later, until a newer one of its kind and key.

        From any thread.
        """
        text = msgspec.json.encode({"kind": kind, **message}).decode()
        self._call_soon(self._publish, kind if key is None else f"{kind}/{key}", text)

    def add_rows(self, rows: Sequence[Any], reset: bool = False) -> None:
        """Send rows after those before; ``reset``: instead of those before. From any thread."""
        self._call_soon(self._add_rows, [msgspec.json.encode(row) for row in rows], reset)

    def keep_rows(self, count: int) -> None:
        """Keep only this many of the newest rows for pages that are opened later."""
        self._call_soon(self._keep_rows, count)

    def add_resource(self, path: str, content_type: str, data: bytes) -> None:
        """Serve bytes under a path, such as ``/mesh/0``; from any thread."""
        self._resources[path] = (content_type, data)

    def close(self) -> None:
        """Close every page and end the thread."""
        self._call_soon(self._stop.set)
        self._thread.join(timeout=5.0)

    def _call_soon(self, function: Callable[..., object], *arguments: object) -> None:
        if self._events is not None:
            with contextlib.suppress(RuntimeError):  # it has ended: no page is open
                self._events.call_soon_threadsafe(function, *arguments)

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except OSError as error:
            self._error = error
        finally:
            self._ready.set()

    async def _serve(self) -> None:
        self._events = asyncio.get_running_loop()
        server = await serve(
            self._connected, self._host, self.port, process_request=self._answer,
            max_size=MAX_MESSAGE, max_queue=16, compression=None, close_timeout=1.0,
            server_header=None, ping_timeout=60, logger=log,
        )  # fmt: skip
        async with server:
            self.port = next(iter(server.sockets)).getsockname()[1]
            self._ready.set()
            await self._stop.wait()

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Answer a request for a file; None: the connection becomes a WebSocket."""
        path = unquote(urlsplit(request.path).path)
        host = urlsplit("//" + request.headers.get("Host", "")).hostname or ""
        refusal = self._access.refusal(request.path, request.headers)
        if refusal is None and not is_loopback(host):  # a foreign name that leads to this machine
            refusal = f"this page is at {self.url}"
        if refusal is not None:
            return _response(403, "Forbidden", "text/plain", refusal.encode())
        if path == "/socket":
            return None
        if path in self._resources:
            return _response(200, "OK", *self._resources[path])
        name = path.removeprefix("/") or "index.html"
        file = STATIC / name
        if "/" in name or name.startswith(".") or not file.is_file():
            return _response(404, "Not Found", "text/plain", b"there is no such file\n")
        ending = "." + name.rpartition(".")[2]
        kind = TYPES.get(ending) or mimetypes.guess_type(name)[0] or "application/octet-stream"
        return _response(200, "OK", kind, file.read_bytes())

    async def _connected(self, connection: ServerConnection) -> None:
        client = _Client()
        client.waiting = dict(self._kept)
        client.news.set()
        self._clients.add(client)
        sending = asyncio.ensure_future(self._send(connection, client))
        try:
            async for data in connection:
                try:
                    message = msgspec.json.decode(data)
                except (msgspec.MsgspecError, RecursionError):
                    continue
                if isinstance(message, dict):
                    self._on_message(message)
        except ConnectionClosed:
            pass
        finally:
            self._clients.discard(client)
            sending.cancel()

    async def _send(self, connection: ServerConnection, client: _Client) -> None:
        with contextlib.suppress(ConnectionClosed):
            while True:
                await client.news.wait()
                client.news.clear()
                waiting, client.waiting = client.waiting, {}
                for first in ("setup", "looks"):  # what the rows are read with
                    if first in waiting:
                        await connection.send(waiting.pop(first))
                while client.reset or client.row < self._count:
                    await connection.send(self._next_rows(client))
                for text in waiting.values():
                    await connection.send(text)

    def _next_rows(self, client: _Client) -> str:
        first = self._count - len(self._rows)
        begin = max(client.row, first) - first
        rows = [self._rows[k] for k in range(begin, min(begin + CHUNK, len(self._rows)))]
        reset, client.reset, client.row = client.reset, False, first + begin + len(rows)
        head = b'{"kind":"rows","reset":true,"rows":[' if reset else b'{"kind":"rows","rows":['
        return (head + b",".join(rows) + b"]}").decode()

    def _publish(self, kind: str, text: str) -> None:
        self._kept[kind] = text
        for client in self._clients:
            client.waiting[kind] = text
            client.news.set()

    def _add_rows(self, rows: list[bytes], reset: bool) -> None:
        if reset:
            self._rows.clear()
            self._count = 0
        self._rows.extend(rows)
        self._count += len(rows)
        for client in self._clients:
            if reset:
                client.row, client.reset = 0, True
            client.news.set()

    def _keep_rows(self, count: int) -> None:
        while len(self._rows) > count:
            self._rows.popleft()


def _response(status: int, reason: str, content_type: str, body: bytes) -> Response:
    if content_type.startswith("text/"):
        content_type += "; charset=utf-8"
    headers = Headers({
        "Content-Type": content_type, "Content-Length": str(len(body)), "Connection": "close",
        "Cache-Control": "no-store", "Content-Security-Policy": POLICY,
        "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer",
    })  # fmt: skip
    return Response(status, reason, headers, body)
