"""Intentions by Open Sound Control (UDP), a bundle each: ``/igrip/HAND/target "mug"`` and so on.

All values of one intention come in one bundle. What is not known is an empty text or -1, since OSC
has no number for it; ``permitted_for`` is 0 where nothing is permitted.
"""

from __future__ import annotations

import re
from typing import Any

from igrip.errors import requires_extra
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.outputs._address import DatagramSocket

with requires_extra("python-osc", "outputs", "Open Sound Control"):
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
    from pythonosc.osc_message_builder import OscMessageBuilder

UNKNOWN = -1.0


@OUTPUTS.register("osc")
class OscOutput:
    """Sends a bundle for each intention to one address."""

    def __init__(self, options: Options) -> None:
        self._to = options.osc_to
        self._socket = DatagramSocket(options.osc_to, "--osc-to")

    def start(self, loop: Loop) -> None:
        """Announce where intentions go."""
        loop.announce(f"osc.udp://{self._to}")

    def send(self, envelope: Envelope) -> None:
        """Send one bundle."""
        bundle = OscBundleBuilder(IMMEDIATELY)
        message = envelope.to_dict()
        hand = re.sub(r"[^A-Za-z0-9_.-]", "_", message["hand"])  # others mean something in OSC
        for name, value, kind in values_of(message):
            built = OscMessageBuilder(f"/igrip/{hand}/{name}")
            built.add_arg(value, kind)
            bundle.add_content(built.build())
        self._socket.send(bundle.build().dgram)

    def counts(self) -> dict[str, int]:
        """Return how many bundles were sent, and how many could not be."""
        return self._socket.counts()

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def values_of(message: dict[str, Any]) -> list[tuple[str, Any, str]]:
    """Return name, value and OSC type of everything that is sent of an intention."""
    lease, none = message["commitment"] or {}, (message["probability"] or {}).get("none")
    texts = {
        "session": message["session"], "status": message["status"], "target": message["target"],
        "grip": message["grip"], "permitted_target": lease.get("target"),
        "permitted_grip": lease.get("grip"),
    }  # fmt: skip
    numbers = {
        "confidence": message["confidence"], "none": none,
        "time_to_contact": message["time_to_contact"], "age": message["age"],
    }  # fmt: skip
    return [
        ("seq", message["seq"], "i"),
        *((name, value or "", "s") for name, value in texts.items()),
        *((name, UNKNOWN if value is None else value, "f") for name, value in numbers.items()),
        ("permitted_for", message["valid_for"] or 0.0, "f"),
    ]
