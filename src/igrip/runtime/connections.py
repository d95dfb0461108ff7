"""What inputs and outputs are made from, and what they see of the loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from igrip.errors import ObservationError
from igrip.observation import Observation
from igrip.runtime.clock_sync import ClockOffset
from igrip.runtime.protocol import Command

HANDS = ("left", "right")


@dataclass(frozen=True)
class Options:
    """The options of all inputs and outputs; each uses those that concern it.

    Attributes
    ----------
    host, port, token
        Of the WebSocket server; port 0: any that is free.
    stream_name : str
        Of the Lab Streaming Layer streams.
    hands : tuple of str
        The hands that have channels in a signal.
    piped : bool
        Whether a recording is piped through: nothing is dropped, and the run ends with its input.
    shared : dict
        What members share, such as the one server of input and output.
    """

    host: str = "127.0.0.1"
    port: int = 8765
    token: str | None = None
    stream_name: str = "igrip"
    hands: tuple[str, ...] = HANDS
    piped: bool = False
    shared: dict[str, Any] = field(default_factory=dict)


class Sender:
    """The origin of messages: how to reply to it, and the offset of its clock.

    Parameters
    ----------
    reply : function, optional
        Called with the error if a message of this sender is refused; from any thread.
    """

    def __init__(self, reply: Callable[[ObservationError], None] = lambda error: None) -> None:
        self.reply = reply
        self.offset = ClockOffset()


class Receiver(Protocol):
    """The loop, as inputs and outputs see it."""

    @property
    def session(self) -> str:
        """Identifies this run."""
        ...

    def submit(self, message: Observation | Command, sender: Sender, wait: bool = False) -> None:
        """Queue a message; ``wait`` for room rather than drop another. From any thread."""
        ...

    def wait_for_demand(self) -> bool:
        """Block until a message could be handled at once; False: the run is over."""
        ...

    def count(self, event: str) -> None:
        """Count an event, such as a malformed message; from any thread."""
        ...

    def announce(self, address: str) -> None:
        """Tell the user where others can connect."""
        ...

    def status(self) -> dict[str, Any]:
        """Return the newest report; from any thread."""
        ...

    def finish(self, error: Exception | None = None) -> None:
        """End the run after the messages that wait; it raises ``error``, if there is one."""
        ...
