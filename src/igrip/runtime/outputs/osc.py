"""Intentions by Open Sound Control (UDP): one bundle for each, an address for each number."""

from __future__ import annotations

from typing import Any

from igrip.errors import requires_extra
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.outputs._datagrams import Datagrams

with requires_extra("python-osc", "outputs", "Open Sound Control"):
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
    from pythonosc.osc_message_builder import OscMessageBuilder


@OUTPUTS.register("osc")
class OscOutput:
    """``/igrip/HAND/status``, ``target``, ``grip``, ``confidence``, ``time_to_contact``, ``lease``.

    Texts are "" and numbers are -1 where there is none; ``lease`` is for how long a device may
    start an action from receipt [s], 0: not at all.
    """

    def __init__(self, options: Options) -> None:
        self._datagrams = Datagrams(options.osc_to, "--osc-to")

    def start(self, loop: Loop) -> None:
        """Nothing: there is no connection."""

    def send(self, envelope: Envelope) -> None:
        """Send one, or lose it."""
        self._datagrams.send(bundle(envelope.to_dict()))

    def counts(self) -> dict[str, int]:
        """Return how many were sent, and how many the system did not take."""
        return dict(self._datagrams.counts)

    def close(self) -> None:
        """Close the socket."""
        self._datagrams.close()


def bundle(message: dict[str, Any]) -> bytes:
    """Return an intention as a bundle."""
    values = {
        "seq": int(message["seq"]) & 0x7FFFFFFF, "status": message["status"],
        "target": message["target"] or "", "grip": message["grip"] or "",
        "confidence": _number(message["confidence"]),
        "time_to_contact": _number(message["time_to_contact"]),
        "lease": float(message["valid_for"] or 0.0),
    }  # fmt: skip
    whole = OscBundleBuilder(IMMEDIATELY)
    for name, value in values.items():
        one = OscMessageBuilder(address=f"/igrip/{_part(message['hand'])}/{name}")
        one.add_arg(value)
        whole.add_content(one.build())
    data: bytes = whole.build().dgram
    return data


def _number(value: float | None) -> float:
    return -1.0 if value is None else float(value)


def _part(text: str) -> str:
    """Return an id as a part of an address, without the signs that have a meaning there."""
    return "".join("_" if sign in " #*,/?[]{}" else sign for sign in text)
