"""Observations from WebSocket clients."""

from __future__ import annotations

from igrip.runtime.connections import Options, Receiver
from igrip.runtime.inputs import INPUTS
from igrip.runtime.websocket import OBSERVATIONS, WebSocketServer


@INPUTS.register("ws")
class WebSocketInput:
    """The path ``/observations`` of the WebSocket server."""

    single_sender = False

    def __init__(self, options: Options) -> None:
        self._server = WebSocketServer.shared(options, OBSERVATIONS)

    def start(self, loop: Receiver) -> None:
        """Begin to listen."""
        self._server.start(loop)

    def close(self) -> None:
        """End all connections."""
        self._server.close()
