"""The protocol of devices: what may be done for a lease, and what state a device is in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

from igrip.devices.base.settings import Phase
from igrip.errors import IgripError

Condition = Literal["open", "closing", "holding", "fault"]
Cause = Literal["silence", "end", "veto", "fault", "close"]

__all__ = ["Cause", "Condition", "Device", "DeviceError", "DeviceState", "Permit", "Phase"]


class DeviceError(IgripError):
    """A device does not answer, answers wrongly, reports a fault, or cannot be opened."""


@dataclass(frozen=True)
class Permit:
    """One fresh decision, to be acted on at most once.

    Attributes
    ----------
    number : int
        Of the decision; grows, and no number comes twice.
    hand, target, grip : str
        What the action is for.
    model : str or None
        Model of the target, from which its aperture follows.
    phase : str
        ``reach``: shape the hand on its way; ``grasp``: close it.
    until : float
        No action may go on without a newer permit after this time [s], on the device's clock.
    """

    number: int
    hand: str
    target: str
    grip: str
    model: str | None
    phase: Phase
    until: float


@dataclass(frozen=True)
class DeviceState:
    """What a device reports, or what follows from what it was sent.

    Attributes
    ----------
    condition : str
        ``open`` (it does nothing), ``closing``, ``holding`` or ``fault``.
    detail : str
        For the user.
    """

    condition: Condition
    detail: str = ""


class Device(Protocol):
    """One device. Every call is bounded in time and comes from one thread.

    Attributes
    ----------
    min_interval : float
        Shortest time between two permits that it is given [s].
    """

    min_interval: float

    def open(self) -> None:
        """Connect; the device does nothing yet.

        Raises
        ------
        DeviceError
            If it is not there or does not answer.
        """

    def allow(self, permit: Permit) -> None:
        """Act as this permit says, or go on doing so.

        Raises
        ------
        DeviceError
            If the device refuses or does not answer; its state is not known then.
        """

    def stop(self, cause: Cause = "end") -> None:
        """End what it does; may be called at any time, any number of times.

        ``silence`` (the lease ended) while it holds does what ``when_silent`` of its settings says.

        Raises
        ------
        DeviceError
            If the command could not be sent.
        """

    def state(self) -> DeviceState:
        """Return its state, without waiting for it."""

    def keep_alive(self) -> None:
        """Keep an idle connection open; called for fresh messages only, while nothing is done."""

    def close(self) -> None:
        """Stop it and disconnect; may be called twice."""
