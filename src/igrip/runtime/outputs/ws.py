"""Intentions to WebSocket clients."""

from __future__ import annotations

from igrip.runtime.connections import Options, Receiver
from igrip.runtime.envelope import Envelope
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.websocket import INTENTIONS, WebSocketServer


@OUTPUTS.register("ws")
class WebSocketOutput:
    """The path ``/intentions`` of the WebSocket server."""

    def __init__(self, options: Options) -> None:
        self._server = WebSocketServer.shared(options, INTENTIONS)

    def start(self, loop: Receiver) -> None:
        """Begin to listen."""
        self._server.start(loop)

    def send(self, envelope: Envelope) -> None:
        """Queue an intention for every client."""
        self._server.send(envelope)

    def close(self) -> None:
        """End all connections."""
        self._server.close()

    def counts(self) -> dict[str, int]:
        """Return how many messages were sent and lost, and how many clients there are."""
        return self._server.counts()
