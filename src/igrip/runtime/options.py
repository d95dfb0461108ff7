"""The options of all inputs and outputs; each uses those that concern it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from igrip.io.frames import DeclaredFrame

HANDS = ("left", "right")


@dataclass(frozen=True)
class Options:
    """What an input or an output is made from."""

    host: str = "127.0.0.1"  # host, port and token are those of the WebSocket server
    port: int = 8765  # 0: any that is free
    token: str | None = None
    stream_name: str = "igrip"  # of the Lab Streaming Layer streams
    source_name: str | None = None  # of the LSL stream that is read; None: each of type MoCap
    osc_port: int = 9000  # 0: any that is free
    hands: tuple[str, ...] = HANDS  # that have channels in a signal
    frame: DeclaredFrame = field(default_factory=DeclaredFrame)  # of what inputs receive
    udp_to: str = "127.0.0.1:9870"
    osc_to: str = "127.0.0.1:9001"
    mqtt: str = "mqtt://127.0.0.1:1883/igrip"  # [mqtt|mqtts]://[user:password@]host[:port]/prefix
    ros_frame: str = "world"  # the frame of poses that are sent
    shared: dict[str, Any] = field(default_factory=dict)  # such as one server of input and output
