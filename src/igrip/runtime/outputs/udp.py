"""Intentions as datagrams of JSON (UDP), one each."""

from __future__ import annotations

from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.outputs._address import DatagramSocket


@OUTPUTS.register("udp")
class UdpOutput:
    """Sends each intention to one address; a datagram that is lost stays lost."""

    def __init__(self, options: Options) -> None:
        self._to = options.udp_to
        self._socket = DatagramSocket(options.udp_to, "--udp-to")

    def start(self, loop: Loop) -> None:
        """Announce where intentions go."""
        loop.announce(f"udp://{self._to}")

    def send(self, envelope: Envelope) -> None:
        """Send one datagram."""
        self._socket.send(envelope.to_json())

    def counts(self) -> dict[str, int]:
        """Return how many datagrams were sent, and how many could not be."""
        return self._socket.counts()

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
