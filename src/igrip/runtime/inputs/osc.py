"""Observations by Open Sound Control (UDP): a name and 3 or 7 numbers, or JSON as text.

``/right_hand 0.1 0.3 0.05`` is a hand, ``/mug 0.2 0.5 0.1 0 0 0 1`` an object; the name may be the
first argument too, as in VMC (``/VMC/Ext/Tra/Pos "right" …``). What is in one bundle is one
message.
"""

from __future__ import annotations

import re
import socket
import threading
from collections import OrderedDict
from collections.abc import Sequence
from typing import Any

from igrip.errors import IgripError, ObservationError, requires_extra
from igrip.observation import Observation
from igrip.runtime.access import is_loopback
from igrip.runtime.inputs import INPUTS
from igrip.runtime.inputs._named_poses import NamedPoses
from igrip.runtime.loop import Loop, Sender
from igrip.runtime.options import Options
from igrip.runtime.protocol import Command

with requires_extra("python-osc", "outputs", "Open Sound Control"):
    from pythonosc.osc_message import OscMessage
    from pythonosc.osc_packet import OscPacket

MAX_PACKET = 65_535  # bytes
MAX_SENDERS = 32
POLL = 0.2  # s after which the thread looks whether it shall end
IMMEDIATELY = b"\x00" * 7 + b"\x01"  # the time tag of a bundle without a time
_NO_NAMES = {"position", "pos", "pose", "tra", "xyz", "tracker", "vmc", "ext", "igrip", "hand",
             "object", "rigidbody", "data"}  # fmt: skip


@INPUTS.register("osc")
class OscInput:
    """Receives packets on a UDP port, in a thread; each address that sends is a sender."""

    single_sender = False

    def __init__(self, options: Options) -> None:
        self._address = (options.host, options.osc_port)
        self._frame, self._poses = options.frame, NamedPoses(options.hands)
        self._senders: OrderedDict[str, Sender] = OrderedDict()
        self._stop = threading.Event()
        self.port = options.osc_port

    def start(self, loop: Loop) -> None:
        """Begin to receive.

        Raises
        ------
        IgripError
            If the port cannot be used.
        """
        self._loop = loop
        family = socket.AF_INET6 if ":" in self._address[0] else socket.AF_INET
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        try:
            self._socket.bind(self._address)
        except OSError as error:
            self._socket.close()
            where = f"{self._address[0]}:{self._address[1]}"
            raise IgripError(f"cannot receive OSC on {where}: {error.strerror}") from error
        self._socket.settimeout(POLL)
        self.port = self._socket.getsockname()[1]
        loop.announce(f"osc.udp://{self._address[0]}:{self.port}")
        if not is_loopback(self._address[0]):
            loop.warn("osc: whoever reaches this port can send hands; OSC knows no token")
        self._thread = threading.Thread(target=self._run, name="igrip-osc", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Receive no more."""
        self._stop.set()
        if hasattr(self, "_thread"):
            self._thread.join(timeout=5.0)
            self._socket.close()

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                data, address = self._socket.recvfrom(MAX_PACKET)
            except TimeoutError:
                continue
            except OSError:
                return
            try:
                self._receive(data, address[0])
            except ObservationError as error:
                self._loop.count("malformed")
                self._loop.warn(f"osc: {error}")

    def _receive(self, data: bytes, address: str) -> None:
        try:
            timed = OscPacket(data).messages
        except Exception as error:  # the package lets errors of its parts through
            raise ObservationError("message", f"is no OSC packet: {error!r:.120}") from None
        dated = data.startswith(b"#bundle\0") and data[8:16] != IMMEDIATELY
        sender = self._sender(f"osc {address}{' (dated)' if dated else ''}")
        message: dict[str, Any] = {"hands": {}, "objects": {}}
        message["t"] = timed[0].time if dated and timed else self._loop.now() / self._frame.seconds
        for one in timed:
            text = one.message.params[0] if one.message.params else None
            if isinstance(text, str) and text.lstrip().startswith("{"):
                self._submit(sender.decode(text), sender)
            else:
                self._add(message, one.message)
        if message["hands"] or message["objects"]:
            self._submit(sender.read(message), sender)

    def _add(self, message: dict[str, Any], received: OscMessage) -> None:
        name, numbers = name_and_numbers(received.address, received.params)
        if len(numbers) not in (3, 7):
            raise ObservationError(
                received.address[:80],
                f"has {len(numbers)} numbers; a position has 3, a pose 7 (position, quaternion)",
            )
        self._poses.add(message, name, numbers[:3], numbers[3:] or None)
        if name in self._poses.refused:
            self._loop.warn(f"osc: {self._poses.refused[name]}")

    def _submit(self, message: Observation | Command, sender: Sender) -> None:
        self._loop.submit(message, sender)

    def _sender(self, name: str) -> Sender:
        if name not in self._senders:
            if len(self._senders) >= MAX_SENDERS:
                self._senders.popitem(last=False)
            self._senders[name] = Sender(name=name, frame=self._frame)
        return self._senders[name]


def name_and_numbers(address: str, params: Sequence[Any]) -> tuple[str, list[float]]:
    """Return the name of a hand or object and the numbers that follow it in a message."""
    numbers = [float(x) for x in params if isinstance(x, int | float) and not isinstance(x, bool)]
    texts = [x for x in params if isinstance(x, str) and x]
    if texts:
        return texts[0], numbers
    parts = [part for part in address.split("/") if part]
    named = [part for part in parts if re.sub(r"\d+$", "", part).lower() not in _NO_NAMES]
    return (named or parts or ["?"])[-1], numbers
