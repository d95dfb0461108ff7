"""A pose estimator in another process: newest frame out, poses back, over one socket.

Each message is a length (4 bytes, big endian), that many bytes of JSON, and for a frame its pixels:
``height × width × 3`` bytes of red, green and blue, and with ``depth`` as many float32 (little
endian, metres). The other side needs nothing but a standard Python for it.
"""

from __future__ import annotations

import contextlib
import json
import socket
import struct
import threading
from typing import Any, NamedTuple

import numpy as np

from igrip.errors import IgripError
from igrip.rgbd import RgbdFrame
from igrip.runtime.mailbox import Mailbox

PROTOCOL = "igrip-poses/1"
MAX_ANSWER = 4_000_000  # bytes: thousands of poses
RETRY_AFTER = 0.5  # s
MAX_ANSWERS = 8  # that wait to be read


class Answer(NamedTuple):
    """What the server found in a frame."""

    frame: RgbdFrame
    poses: list[Any]  # as they came: not checked


class _Request(NamedTuple):
    number: int
    frame: RgbdFrame
    depth: bool


class PoseServerClient:
    """A connection to a pose server, in a thread of its own; reconnects when it breaks.

    A reply may take ``timeout`` [s]. Where nothing listens at first, an IgripError is raised;
    what is wrong later is in ``problem``.
    """

    def __init__(self, host: str, port: int, timeout: float) -> None:
        self._address, self._timeout = (host, port), timeout
        self._requests: Mailbox[_Request] = Mailbox()
        self._changed = threading.Condition()
        self._answers: list[Answer] = []
        self._offered = self._done = 0  # numbers of the newest frame, and of the newest worked on
        self._closed = False
        self.problem: str | None = None
        try:
            self._socket: socket.socket | None = self._connect()
        except OSError as error:
            raise IgripError(
                f"no pose server listens on {host}:{port} ({error}); start one: docs/cosypose.md"
            ) from error
        self._thread = threading.Thread(target=self._run, name="igrip-poses", daemon=True)
        self._thread.start()

    def offer(self, frame: RgbdFrame, depth: bool = False) -> None:
        """Send this frame next, instead of one that still waits."""
        self._offered += 1
        self._requests.put(_Request(self._offered, frame, depth and frame.depth is not None))

    def answers(self, wait: float = 0.0) -> list[Answer]:
        """Return what came since the last call, oldest first.

        It waits so long [s], at most, for the frame that was offered last to be answered.
        """
        with self._changed:
            if wait > 0.0:
                self._changed.wait_for(lambda: self._closed or self._done >= self._offered, wait)
            answers, self._answers = self._answers, []
        return answers

    def close(self) -> None:
        """Close the connection and end the thread; may be called twice."""
        self._requests.close()
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._disconnect()
        self._thread.join(timeout=5.0)

    def _connect(self) -> socket.socket:
        connection = socket.create_connection(self._address, timeout=self._timeout)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return connection

    def _disconnect(self) -> None:
        connection, self._socket = self._socket, None
        if connection is not None:
            with contextlib.suppress(OSError):  # wakes a thread that reads
                connection.shutdown(socket.SHUT_RDWR)
            connection.close()

    def _run(self) -> None:
        while not self._closed:
            request = self._requests.get()
            if request is None or self._closed:
                return
            answers: list[Answer] = []
            try:
                if self._socket is None:
                    self._socket = self._connect()
                answers.append(self._ask(self._socket, request))
            except (OSError, ValueError) as error:
                self._disconnect()
                self.problem = f"the pose server {self._address[0]}:{self._address[1]}: {error}"
            with self._changed:
                if not answers:
                    self._changed.wait_for(lambda: self._closed, RETRY_AFTER)
                self._answers = [*self._answers, *answers][-MAX_ANSWERS:]
                self._done = request.number
                self._changed.notify_all()

    def _ask(self, connection: socket.socket, request: _Request) -> Answer:
        frame = request.frame
        header = {
            "schema": PROTOCOL,
            "seq": request.number,
            "t": frame.t,
            "width": frame.colour.shape[1],
            "height": frame.colour.shape[0],
            "matrix": frame.intrinsics.matrix.tolist(),
            "depth": request.depth,
        }
        packed = json.dumps(header).encode()
        connection.sendall(struct.pack(">I", len(packed)) + packed)
        connection.sendall(np.ascontiguousarray(frame.colour).data)
        if request.depth and frame.depth is not None:
            connection.sendall(np.ascontiguousarray(frame.depth, dtype="<f4").data)
        (length,) = struct.unpack(">I", _receive(connection, 4))
        if length > MAX_ANSWER:
            raise ValueError("its reply cannot be read")
        try:
            answer = json.loads(_receive(connection, length))
        except (ValueError, RecursionError):
            raise ValueError("its reply is not JSON") from None
        if not isinstance(answer, dict) or answer.get("seq") != request.number:
            raise ValueError("its reply belongs to another frame")
        if "error" in answer:
            self.problem = f"the pose server reports: {answer['error']!s:.300}"
            return Answer(frame, [])
        poses = answer.get("poses")
        if not isinstance(poses, list):
            raise ValueError("its reply holds no poses")
        self.problem = None
        return Answer(frame, poses)


def _receive(connection: socket.socket, length: int) -> bytes:
    received = bytearray()
    while len(received) < length:
        piece = connection.recv(min(length - len(received), 1 << 20))
        if not piece:
            raise ConnectionError("it has closed the connection")
        received += piece
    return bytes(received)
