"""The options of all inputs and outputs; each uses those that concern it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

HANDS = ("left", "right")


@dataclass(frozen=True)
class Options:
    """What an input or an output is made from.

    Attributes
    ----------
    host, port, token
        Of the WebSocket server; port 0: any that is free.
    stream_name : str
        Of the Lab Streaming Layer streams.
    hands : tuple of str
        The hands that have channels in a signal.
    shared : dict
        What members share, such as the one server of input and output.
    """

    host: str = "127.0.0.1"
    port: int = 8765
    token: str | None = None
    stream_name: str = "igrip"
    hands: tuple[str, ...] = HANDS
    shared: dict[str, Any] = field(default_factory=dict)
