"""Intentions as datagrams of JSON."""

from __future__ import annotations

from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.outputs._datagrams import Datagrams


@OUTPUTS.register("udp")
class UdpOutput:
    """One datagram for each intention; nothing says whether it arrives."""

    def __init__(self, options: Options) -> None:
        self._datagrams = Datagrams(options.udp_to, "--udp-to")

    def start(self, loop: Loop) -> None:
        """Nothing: there is no connection."""

    def send(self, envelope: Envelope) -> None:
        """Send one, or lose it."""
        self._datagrams.send(envelope.to_json())

    def counts(self) -> dict[str, int]:
        """Return how many were sent, and how many the system did not take."""
        return dict(self._datagrams.counts)

    def close(self) -> None:
        """Close the socket."""
        self._datagrams.close()
