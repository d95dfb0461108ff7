"""Outputs of the loop, by name: where intentions go."""

from __future__ import annotations

from typing import Protocol

from igrip.registry import Registry
from igrip.runtime.connections import Options, Receiver
from igrip.runtime.envelope import Envelope


class Output(Protocol):
    """Sends intentions to other programs; made from options, and never blocks the loop."""

    def __init__(self, options: Options) -> None:
        """Check the options; connect to nothing yet."""
        ...

    def start(self, loop: Receiver) -> None:
        """Open the connection."""
        ...

    def send(self, envelope: Envelope) -> None:
        """Send an intention, now or soon.

        Raises
        ------
        BrokenPipeError
            If nobody can receive it any more.
        """
        ...

    def close(self) -> None:
        """Send what waits, for a bounded time, and disconnect; may be called twice."""
        ...

    def counts(self) -> dict[str, int]:
        """Return how many intentions were ``sent``, and how many were ``lost``."""
        ...


OUTPUTS: Registry[type[Output]] = Registry("output", "igrip.runtime.outputs", "igrip.outputs")
