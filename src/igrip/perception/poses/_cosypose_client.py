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

PROTOCOL = "igrip-poses/1"
LARGEST = 4_000_000  # bytes of an answer: thousands of poses
AGAIN = 0.5  # s until the next attempt to connect


class Answer(NamedTuple):
    """What was found in a frame.

    Attributes
    ----------
    frame : RgbdFrame
        The frame.
    poses : list
        As they came: not checked.
    """

    frame: RgbdFrame
    poses: list[Any]


class Remote:
    """A connection, in a thread of its own, that is made anew when it breaks.

    Parameters
    ----------
    host, port
        Of the server.
    patience : float
        An answer is waited for so long [s].

    Raises
    ------
    IgripError
        If nobody listens there.
    """

    def __init__(self, host: str, port: int, patience: float) -> None:
        self._address, self._patience = (host, port), patience
        self._changed = threading.Condition()
        self._next: tuple[RgbdFrame, bool] | None = None
        self._answers: list[Answer] = []
        self._busy = self._closed = False
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
        """Let a frame be the next to be sent; one that still waits is forgotten."""
        with self._changed:
            self._next = frame, depth and frame.depth is not None
            self._changed.notify_all()

    def answers(self, wait: float = 0.0) -> list[Answer]:
        """Return what came since the last call, oldest first.

        Parameters
        ----------
        wait : float
            For what was offered to be answered, at most [s].
        """
        with self._changed:
            if wait > 0.0:
                self._changed.wait_for(
                    lambda: self._closed or (self._next is None and not self._busy), wait
                )
            answers, self._answers = self._answers, []
        return answers

    def close(self) -> None:
        """Close the connection and end the thread; may be called twice."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._drop()
        self._thread.join(timeout=5.0)

    def _connect(self) -> socket.socket:
        connection = socket.create_connection(self._address, timeout=self._patience)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return connection

    def _drop(self) -> None:
        connection, self._socket = self._socket, None
        if connection is not None:
            with contextlib.suppress(OSError):  # wakes a thread that reads
                connection.shutdown(socket.SHUT_RDWR)
            connection.close()

    def _run(self) -> None:
        number = 0
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._closed or self._next is not None)
                if self._closed or self._next is None:
                    return
                (frame, depth), self._next, self._busy = self._next, None, True
            number += 1
            try:
                if self._socket is None:
                    self._socket = self._connect()
                answer = self._ask(self._socket, number, frame, depth)
            except (OSError, ValueError) as error:
                self._drop()
                self.problem = f"the pose server {self._address[0]}:{self._address[1]}: {error}"
                with self._changed:
                    self._changed.wait_for(lambda: self._closed, AGAIN)
                continue
            with self._changed:
                self._answers.append(answer)
                del self._answers[:-8]  # nobody has asked for long: only the newest count

    def _ask(self, connection: socket.socket, number: int, frame: RgbdFrame, depth: bool) -> Answer:
        header = {
            "schema": PROTOCOL,
            "seq": number,
            "t": frame.t,
            "width": frame.colour.shape[1],
            "height": frame.colour.shape[0],
            "matrix": frame.intrinsics.matrix.tolist(),
            "depth": depth,
        }
        words = json.dumps(header).encode()
        connection.sendall(struct.pack(">I", len(words)) + words)
        connection.sendall(np.ascontiguousarray(frame.colour).data)
        if depth and frame.depth is not None:
            connection.sendall(np.ascontiguousarray(frame.depth, dtype="<f4").data)
        (length,) = struct.unpack(">I", _receive(connection, 4))
        if length > LARGEST:
            raise ValueError("its answer makes no sense")
        try:
            said = json.loads(_receive(connection, length))
        except (ValueError, RecursionError):
            raise ValueError("its answer is not JSON") from None
        if not isinstance(said, dict) or said.get("seq") != number:
            raise ValueError("it does not answer what it was asked")
        if "error" in said:
            self.problem = f"the pose server says: {said['error']!s:.300}"
            return Answer(frame, [])
        poses = said.get("poses")
        if not isinstance(poses, list):
            raise ValueError("its answer holds no poses")
        self.problem = None
        return Answer(frame, poses)


def _receive(connection: socket.socket, length: int) -> bytes:
    received = bytearray()
    while len(received) < length:
        piece = connection.recv(min(length - len(received), 1 << 20))
        if not piece:
            raise ConnectionError("it has gone away")
        received += piece
    return bytes(received)
