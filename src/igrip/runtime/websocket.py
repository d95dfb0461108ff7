"""A WebSocket server: observations in, intentions out, for any number of clients of any speed."""

from __future__ import annotations

import asyncio
import contextlib
import http
import json
import logging
import math
import threading
import weakref
from collections import Counter
from collections.abc import Callable, Coroutine
from typing import Any
from urllib.parse import parse_qs, urlsplit

from igrip.errors import IgripError, ObservationError, requires_extra
from igrip.io.frames import DeclaredFrame
from igrip.runtime.access import Access
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop, Sender
from igrip.runtime.options import Options
from igrip.runtime.protocol import MAX_SIZE, Command

with requires_extra("websockets", "outputs", "the WebSocket server"):
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.exceptions import ConnectionClosed
    from websockets.http11 import Request, Response

OBSERVATIONS, INTENTIONS = "/observations", "/intentions"
MAX_CLIENTS = 32
MAX_BEHIND = 1024  # intentions that may wait for one client
REPLY_INTERVAL = 1.0  # s between two replies to a client about messages that were not accepted
TOO_LARGE = 1009  # RFC 6455
TRY_LATER = 1013  # RFC 6455 registry: try again later

# clients that connect and vanish would fill the terminal: these are no errors of ours
log = logging.getLogger("igrip.websocket")
log.addHandler(logging.NullHandler())
log.propagate = False


def _address(connection: ServerConnection) -> str:
    address = connection.remote_address
    return ":".join(map(str, address[:2])) if isinstance(address, tuple) else "unknown"


class _Client:
    """One connection; all that is known of it ends with it."""

    def __init__(self, connection: ServerConnection, sender: Sender) -> None:
        self.connection, self.sender = connection, sender
        self.waiting: asyncio.Queue[Envelope] = asyncio.Queue(MAX_BEHIND)
        self._replied, self._unanswered = -math.inf, 0

    async def reply(self, error: ObservationError) -> None:
        """Report what was wrong with a message, but not too often."""
        now = asyncio.get_running_loop().time()
        self._unanswered += 1
        if now - self._replied < REPLY_INTERVAL:
            return
        reply = {"error": str(error), "field": error.field, "count": self._unanswered}
        self._replied, self._unanswered = now, 0
        with contextlib.suppress(ConnectionClosed, TimeoutError):
            await asyncio.wait_for(self.connection.send(json.dumps(reply)), REPLY_INTERVAL)


class WebSocketServer:
    """``/observations`` (in), ``/intentions`` (out) and ``/status`` (HTTP), in its own thread.

    Commands are accepted on both paths, observations on their own only. It serves the paths that
    :meth:`shared` is called with.

    Parameters
    ----------
    host, port
        Where to listen; port 0: any that is free.
    access : Access
        Who may connect.
    frame : DeclaredFrame, optional
        Frame and units of the observations.
    """

    single_sender = False

    def __init__(
        self, host: str, port: int, access: Access, frame: DeclaredFrame | None = None
    ) -> None:
        self._host, self.port, self._access, self._frame = host, port, access, frame
        self._connections = 0
        self._paths: set[str] = set()
        self._clients: set[_Client] = set()
        self._listeners: set[_Client] = set()  # clients of /intentions
        self._counts: Counter[str] = Counter()
        self._events: asyncio.AbstractEventLoop | None = None
        self._background: set[asyncio.Task[None]] = set()
        self._stop = asyncio.Event()
        self._ready = threading.Event()
        self._error: OSError | None = None
        self._thread: threading.Thread | None = None

    @classmethod
    def shared(cls, options: Options, path: str) -> WebSocketServer:
        """Return the one server of a run; it serves this path too."""
        if "websocket" not in options.shared:
            access = Access(options.host, options.token)
            options.shared["websocket"] = cls(options.host, options.port, access, options.frame)
        server: WebSocketServer = options.shared["websocket"]
        server._paths.add(path)
        return server

    def start(self, loop: Loop) -> None:
        """Begin to listen, unless it does so already.

        Raises
        ------
        IgripError
            If the address cannot be listened on.
        """
        if self._thread is not None:
            return
        self._loop = loop
        self._thread = threading.Thread(target=self._run, name="igrip-websocket", daemon=True)
        self._thread.start()
        self._ready.wait()
        if self._error is not None:
            raise IgripError(f"cannot listen on {self._host}:{self.port}: {self._error.strerror}")
        host = f"[{self._host}]" if ":" in self._host else self._host
        loop.announce(f"ws://{host}:{self.port}")

    def send(self, envelope: Envelope) -> None:
        """Queue an intention for every client; never blocks."""
        self._call_soon(self._send_to_all, envelope)

    def counts(self) -> dict[str, int]:
        """Return how many messages were sent and lost, and how many clients there are."""
        return dict(self._counts) | {"clients": len(self._listeners)}

    def close(self) -> None:
        """Close all connections and end the thread."""
        self._call_soon(self._stop.set)
        if self._thread is not None:
            self._thread.join(timeout=5.0)

    def _call_soon(self, function: Callable[..., object], *arguments: object) -> None:
        """Call a function in the server's thread; from any thread."""
        if self._events is not None:
            with contextlib.suppress(RuntimeError):  # the server has ended: nobody is connected
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
        async with serve(
            self._connected, self._host, self.port, process_request=self._answer,
            max_size=MAX_SIZE, max_queue=16, compression=None, close_timeout=1.0,
            server_header=None, ping_timeout=60, logger=log,
        ) as server:  # fmt: skip
            self.port = server.sockets[0].getsockname()[1]
            self._ready.set()
            await self._stop.wait()

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Respond to requests that do not become a connection."""
        path = urlsplit(request.path).path
        refusal = self._access.refusal(request.path, request.headers)
        if refusal is not None:
            self._loop.warn(f"refused {_address(connection)}: {refusal}")
            return connection.respond(http.HTTPStatus.FORBIDDEN, refusal + "\n")
        if path == "/status":
            body = json.dumps(self._loop.status()) + "\n"
            response = connection.respond(http.HTTPStatus.OK, body)
            response.headers["Content-Type"] = "application/json"
            return response
        if path not in self._paths:
            reason = f"there are {', '.join(sorted(self._paths))} and /status\n"
            return connection.respond(http.HTTPStatus.NOT_FOUND, reason)
        if len(self._clients) >= MAX_CLIENTS:
            reason = f"there are {MAX_CLIENTS} clients already\n"
            return connection.respond(http.HTTPStatus.SERVICE_UNAVAILABLE, reason)
        return None

    async def _connected(self, connection: ServerConnection) -> None:
        assert connection.request is not None
        url = urlsplit(connection.request.path)
        self._connections += 1
        name = f"client {self._connections} ({_address(connection)})"
        sender = Sender(name=name, frame=self._frame)
        client = _Client(connection, sender)
        known = weakref.ref(client)  # what is reported of a sender outlives its connection
        sender.reply = lambda error: self._call_soon(self._reply, known, error)
        self._clients.add(client)
        try:
            if url.path == OBSERVATIONS:
                await self._receive(client, observations=True)
            else:
                await self._converse(client, parse_qs(url.query).get("format") == ["msgpack"])
        finally:
            self._clients.discard(client)

    def _reply(self, known: weakref.ref[_Client], error: ObservationError) -> None:
        client = known()
        if client is not None:
            self._run_in_background(client.reply(error))

    def _run_in_background(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._background.add(task)
        task.add_done_callback(self._background.discard)

    async def _receive(self, client: _Client, observations: bool) -> None:
        """Submit what a client sends, until it goes."""
        try:
            async for data in client.connection:
                await self._accept(data, client, observations)
                await asyncio.sleep(0)  # one that floods must not keep the others from being served
        except ConnectionClosed as closed:
            if closed.sent is not None and closed.sent.code == TOO_LARGE:
                self._loop.count("too_large")

    async def _accept(self, data: bytes | str, client: _Client, observations: bool) -> None:
        try:
            message = client.sender.decode(data)
        except ObservationError as error:
            self._loop.count("malformed")
            await client.reply(error)
            return
        if observations or isinstance(message, Command):
            self._loop.submit(message, client.sender)
        else:
            self._loop.count("refused")
            await client.reply(ObservationError("message", "observations are not accepted here"))

    async def _converse(self, client: _Client, packed: bool) -> None:
        """Send intentions to a client and receive its commands, until it goes."""
        tasks = [
            asyncio.ensure_future(self._receive(client, observations=False)),
            asyncio.ensure_future(self._send_waiting(client, packed)),
        ]
        self._listeners.add(client)
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        self._listeners.discard(client)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        self._counts["lost"] += client.waiting.qsize()

    async def _send_waiting(self, client: _Client, packed: bool) -> None:
        """Send intentions, each as it is at that moment."""
        while True:
            envelope = await client.waiting.get()
            # text frames for JSON: a browser makes a blob of the others
            data = envelope.to_msgpack() if packed else envelope.to_json().decode()
            try:
                await client.connection.send(data)
            except BaseException:
                self._counts["lost"] += 1
                raise
            self._counts["sent"] += 1

    def _send_to_all(self, envelope: Envelope) -> None:
        for client in list(self._listeners):
            try:
                client.waiting.put_nowait(envelope)
            except asyncio.QueueFull:
                self._counts["lost"] += 1
                self._counts["dropped_clients"] += 1
                self._listeners.discard(client)
                self._run_in_background(self._drop(client.connection))

    async def _drop(self, connection: ServerConnection) -> None:
        """Close a client that is too slow, whether it listens or not."""
        with contextlib.suppress(Exception):
            await asyncio.wait_for(
                connection.close(TRY_LATER, f"too slow: {MAX_BEHIND} intentions behind"), 2.0
            )
        connection.transport.abort()
