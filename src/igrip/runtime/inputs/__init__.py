"""Inputs of the loop, by name: where observations and commands come from."""

from __future__ import annotations

from typing import Protocol

from igrip.registry import Registry
from igrip.runtime.connections import Options, Receiver


class Input(Protocol):
    """Submits messages to the loop from threads of its own."""

    def start(self, loop: Receiver) -> None:
        """Begin to submit messages."""
        ...

    def close(self) -> None:
        """Submit no more; may be called twice."""
        ...


class NamedInput(Input, Protocol):
    """An input that is chosen by name and made from options.

    Attributes
    ----------
    single_sender : bool
        Whether all messages come from one sender and end with it. Alone, such an input can run
        on the sender's clock.
    """

    single_sender: bool

    def __init__(self, options: Options) -> None:
        """Check the options; connect to nothing yet."""
        ...


INPUTS: Registry[type[NamedInput]] = Registry("input", "igrip.runtime.inputs", "igrip.inputs")
