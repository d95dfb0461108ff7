"""What an output is: something that takes envelopes and never waits."""

from __future__ import annotations

from typing import Protocol

from igrip.registry import Registry
from igrip.runtime.envelope import Envelope


class Output(Protocol):
    """One way out."""

    def send(self, envelope: Envelope) -> None:
        """Take an intention; return at once, whatever becomes of it."""

    def close(self) -> None:
        """Say goodbye."""

    def counts(self) -> dict[str, int]:
        """Return how many messages were sent, and how many lost, by why."""


OUTPUTS: Registry[type[Output]] = Registry("output", "igrip.runtime.outputs", "igrip.outputs")
