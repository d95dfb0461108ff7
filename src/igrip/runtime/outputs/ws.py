"""Intentions to WebSocket clients: the path ``/intentions`` of the server."""

from __future__ import annotations

from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.websocket import INTENTIONS, WebSocketServer


@OUTPUTS.register("ws")
def websocket_output(options: Options) -> WebSocketServer:
    """Return the server of the run; it sends intentions."""
    return WebSocketServer.shared(options, INTENTIONS)
