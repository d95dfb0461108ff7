"""Observations from WebSocket clients: the path ``/observations`` of the server."""

from __future__ import annotations

from igrip.runtime.inputs import INPUTS
from igrip.runtime.options import Options
from igrip.runtime.websocket import OBSERVATIONS, WebSocketServer


@INPUTS.register("ws")
def websocket_input(options: Options) -> WebSocketServer:
    """Return the server of the run; it accepts observations."""
    return WebSocketServer.shared(options, OBSERVATIONS)
