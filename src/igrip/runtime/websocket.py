"""A WebSocket server: observations in, intentions out, to any number of clients of any speed."""

from __future__ import annotations

import asyncio
import contextlib
import http
import json
import logging
import threading
from collections import Counter
from collections.abc import Callable, Coroutine
from typing import Any
from urllib.parse import parse_qs, urlsplit

from igrip.errors import IgripError, MissingExtraError, ObservationError
from igrip.observation import Observation
from igrip.runtime.access import Access
from igrip.runtime.envelope import Envelope
from igrip.runtime.protocol import LARGEST, Command, decode

try:
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.exceptions import ConnectionClosed
    from websockets.http11 import Request, Response
except ImportError:  # pragma: no cover - the extra is there where this is tested
    raise MissingExtraError("websockets", "outputs", "the WebSocket server") from None

MAX_CLIENTS = 32
BEHIND = 1024  # intentions that may wait for one client
ERROR_EVERY = 1.0  # s between two answers to one sender of what cannot be read
TOO_LARGE = 1009  # RFC 6455
TRY_LATER = 1013  # RFC 6455 registry: try again later

# whoever knocks and goes away would fill the terminal: these are no errors of ours
log = logging.getLogger("igrip.websocket")
log.addHandler(logging.NullHandler())
log.propagate = False

Take = Callable[[Observation | Command, object], None]


class WebSocketServer:
    """``/observations`` (in), ``/intentions`` (out) and ``/status`` (HTTP), in a thread of its own.

    Parameters
    ----------
    host, port
        Where to listen; port 0: any that is free.
    access : Access
        Who may connect.
    take : function
        Called with each observation or word that came in, and a key of its sender.
    count : function
        Called with what befell a message that was not taken.
    status : function
        Returns what ``/status`` tells.
    takes, tells : bool
        Whether observations may come in, and intentions go out.

    Raises
    ------
    IgripError
        If the address cannot be listened on.
    """

    def __init__(
        self, host: str, port: int, access: Access, take: Take, count: Callable[[str], None],
        status: Callable[[], dict[str, Any]], takes: bool = True, tells: bool = True,
    ) -> None:  # fmt: skip
        self._access, self._take, self._count, self._status = access, take, count, status
        self._paths = ["/observations"] * takes + ["/intentions"] * tells
        self._clients: dict[ServerConnection, asyncio.Queue[Envelope]] = {}
        self._connections = 0
        self._working: set[asyncio.Future[None]] = set()
        self._open: set[ServerConnection] = set()
        self._answered: dict[ServerConnection, tuple[float, int]] = {}
        self._sent: Counter[str] = Counter()
        self._loop = asyncio.new_event_loop()
        self._stop = asyncio.Event()
        self._ready: threading.Event = threading.Event()
        self._error: OSError | None = None
        self.port = port
        self._thread = threading.Thread(
            target=self._run, args=(host, port), name="igrip-websocket", daemon=True
        )
        self._thread.start()
        self._ready.wait()
        if self._error is not None:
            raise IgripError(f"cannot listen on {host}:{port}: {self._error.strerror}")

    def send(self, envelope: Envelope) -> None:
        """Hand an intention to every client; never waits."""
        with contextlib.suppress(RuntimeError):  # the loop has ended: nobody is there
            self._loop.call_soon_threadsafe(self._spread, envelope)

    def counts(self) -> dict[str, int]:
        """Return how many messages were sent, and how many clients dropped."""
        return dict(self._sent) | {"clients": len(self._clients)}

    def close(self) -> None:
        """Say goodbye to all clients and end the thread."""
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._stop.set)
        self._thread.join(timeout=5.0)

    def _run(self, host: str, port: int) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve(host, port))
        except OSError as error:
            self._error = error
        finally:
            self._ready.set()
            self._loop.close()

    async def _serve(self, host: str, port: int) -> None:
        async with serve(
            self._connected, host, port, process_request=self._asked, max_size=LARGEST,
            max_queue=16, compression=None, close_timeout=1.0, server_header=None, ping_timeout=60,
            logger=log,
        ) as server:  # fmt: skip
            self.port = server.sockets[0].getsockname()[1]
            self._ready.set()
            await self._stop.wait()

    def _asked(self, connection: ServerConnection, request: Request) -> Response | None:
        refusal = self._access.refusal(request.path, request.headers)
        if refusal is not None:
            return connection.respond(http.HTTPStatus.FORBIDDEN, refusal + "\n")
        path = urlsplit(request.path).path
        if path == "/status":
            answer = connection.respond(http.HTTPStatus.OK, json.dumps(self._status()) + "\n")
            answer.headers["Content-Type"] = "application/json"
            return answer
        if path not in self._paths:
            words = f"there are {', '.join(self._paths)} and /status\n"
            return connection.respond(http.HTTPStatus.NOT_FOUND, words)
        if self._connections >= MAX_CLIENTS:
            words = f"there are {MAX_CLIENTS} clients already\n"
            return connection.respond(http.HTTPStatus.SERVICE_UNAVAILABLE, words)
        return None

    async def _connected(self, connection: ServerConnection) -> None:
        assert connection.request is not None
        asked = urlsplit(connection.request.path)
        self._connections += 1
        self._open.add(connection)
        try:
            if asked.path == "/observations":
                await self._receive(connection)
            else:
                packed = parse_qs(asked.query).get("format") == ["msgpack"]
                await self._tell(connection, packed)
        except ConnectionClosed:
            pass
        finally:
            self._connections -= 1
            self._open.discard(connection)
            self._answered.pop(connection, None)
            if connection.close_code == TOO_LARGE:
                self._count("too_large")

    def answer(self, sender: object, error: ObservationError) -> None:
        """Tell a client what was wrong with what it sent, but not too often; from any thread."""
        if isinstance(sender, ServerConnection):
            with contextlib.suppress(RuntimeError):
                self._loop.call_soon_threadsafe(self._answer, sender, error)

    def _answer(self, connection: ServerConnection, error: ObservationError) -> None:
        answered, unanswered = self._answered.get(connection, (-ERROR_EVERY, 0))
        now = self._loop.time()
        if connection not in self._open or now - answered < ERROR_EVERY:
            self._answered[connection] = (answered, unanswered + 1)
            return
        told = {"error": str(error), "field": error.field, "count": unanswered + 1}
        self._answered[connection] = (now, 0)
        self._background(asyncio.wait_for(connection.send(json.dumps(told)), ERROR_EVERY))

    def _background(self, work: Coroutine[Any, Any, None]) -> None:
        async def done() -> None:
            with contextlib.suppress(ConnectionClosed, TimeoutError):
                await work

        task = asyncio.ensure_future(done())
        self._working.add(task)
        task.add_done_callback(self._working.discard)

    async def _receive(self, connection: ServerConnection) -> None:
        """Take what a client sends."""
        async for data in connection:
            try:
                self._take(decode(data), connection)
            except ObservationError as error:
                self._count("malformed")
                self._answer(connection, error)
            await asyncio.sleep(0)  # one that floods must not keep the others from being served

    async def _tell(self, connection: ServerConnection, packed: bool) -> None:
        """Send intentions to one client, each as it is at that moment; take its words."""
        waiting: asyncio.Queue[Envelope] = asyncio.Queue(BEHIND)
        self._clients[connection] = waiting
        listening = asyncio.ensure_future(self._receive(connection))
        try:
            while not listening.done():
                getting = asyncio.ensure_future(waiting.get())
                await asyncio.wait({getting, listening}, return_when=asyncio.FIRST_COMPLETED)
                if not getting.done():
                    getting.cancel()
                    break
                envelope = getting.result()
                # text frames for JSON: a browser makes a blob of the others
                await connection.send(
                    envelope.to_msgpack() if packed else envelope.to_json().decode()
                )
                self._sent["sent"] += 1
        finally:
            self._clients.pop(connection, None)
            self._sent["lost"] += waiting.qsize()
            listening.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionClosed):
                await listening

    def _spread(self, envelope: Envelope) -> None:
        for connection, waiting in list(self._clients.items()):
            try:
                waiting.put_nowait(envelope)
            except asyncio.QueueFull:
                self._sent["lost"] += 1
                self._sent["dropped_clients"] += 1
                del self._clients[connection]
                self._background(self._drop(connection))

    async def _drop(self, connection: ServerConnection) -> None:
        """Tell a client that was too slow, and let it go, whether it listens or not."""
        with contextlib.suppress(Exception):
            await asyncio.wait_for(
                connection.close(TRY_LATER, f"too slow: {BEHIND} intentions behind"), 2.0
            )
        connection.transport.abort()
