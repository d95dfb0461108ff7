"""One sender of messages: its clock, its units, and what was wrong with what it sent."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

from igrip.errors import ObservationError
from igrip.io.defects import Defect, DefectCounts
from igrip.io.first_contact import FirstContact
from igrip.io.frames import DeclaredFrame
from igrip.io.message_reader import MessageReader
from igrip.io.plausibility import options_that_fix, refusal
from igrip.observation import Observation
from igrip.runtime.clock_offset import ClockOffset
from igrip.runtime.protocol import Command, decode

MAX_SENDERS = 32  # that are reported; the newest
EVENT_INTERVAL = 1.0  # s between two texts about one sender


class Sender:
    """The origin of messages.

    Parameters
    ----------
    reply : function, optional
        Called with the error if a message of this sender is refused; from any thread.
    name : str
        For texts.
    frame : DeclaredFrame, optional
        Frame and units of its messages.

    Attributes
    ----------
    offset : ClockOffset
        Of its clock.
    defects : DefectCounts
        What was wrong with its messages.
    refusal : str or None
        Why its numbers cannot be meant as they are taken; its messages are invalid then.
    """

    def __init__(
        self,
        reply: Callable[[ObservationError], None] = lambda error: None,
        name: str = "a sender",
        frame: DeclaredFrame | None = None,
    ) -> None:
        self.reply, self.name = reply, name
        self.offset = ClockOffset(name)
        self.defects = DefectCounts()
        self.refusal: str | None = None
        self.accepted = 0  # messages
        self._remarks: list[str] = []
        self._reader, self._contact = MessageReader(frame), FirstContact(frame)
        self._announced: str | None = None
        self._announced_at = -EVENT_INTERVAL

    def decode(self, data: bytes | str, place: str | None = None) -> Observation | Command:
        """Return a message in JSON or MessagePack; what is wrong with parts of it is counted.

        Raises
        ------
        ObservationError
            If nothing of it can be used.
        """
        defects: list[Defect] = []
        try:
            message = decode(data, self._reader, defects)
        except ObservationError as error:
            self.defects.add(Defect("skipped", "messages", str(error)), place)
            raise
        if isinstance(message, Command):
            return message
        return self._accept(message, defects, place)

    def read(self, raw: Any, place: str | None = None) -> Observation:
        """Return a message that was decoded already; as :meth:`decode`."""
        return self._accept(*self._reader.read(raw), place)

    def _accept(
        self, observation: Observation, defects: list[Defect], place: str | None
    ) -> Observation:
        self.accepted += 1
        for defect in defects:
            self.defects.add(defect, place)
        if self._contact.add(observation):
            findings = self._contact.findings
            problem = refusal(findings)
            fix = options_that_fix(findings)
            self.refusal = problem and f"{problem} {f'({fix})' if fix else ''}".strip()
            self._remarks = [f.text for f in findings if f.verdict == "remark"]
        return observation if self.refusal is None else observation.annotated(invalid=self.refusal)

    def news(self, now: float) -> str | None:
        """Return what happened since it was last asked for, as text, not more than once a second.

        ``now`` is the time of the run [s].
        """
        text = self.refusal or self.offset.event or "; ".join(self._remarks) or None
        if text is None or text == self._announced or now - self._announced_at < EVENT_INTERVAL:
            return None
        self._announced, self._announced_at = text, now
        return text if self.name in text else f"{self.name}: {text}"

    def report(self) -> dict[str, Any]:
        """Return the state of its clock and what was wrong with its messages, as plain data."""
        return {
            "messages": self.accepted, "clock": self.offset.report(), "refused": self.refusal,
            "remarks": list(self._remarks), "defects": self.defects.report(),
        }  # fmt: skip


class Senders:
    """The newest senders of a run, by name."""

    def __init__(self) -> None:
        self._senders: OrderedDict[str, Sender] = OrderedDict()

    def note(self, sender: Sender) -> None:
        """Remember a sender that has sent something."""
        if self._senders.get(sender.name) is not sender:
            self._senders.pop(sender.name, None)
            self._senders[sender.name] = sender
            if len(self._senders) > MAX_SENDERS:
                self._senders.popitem(last=False)

    def report(self) -> dict[str, Any]:
        """Return the reports of all, by name."""
        return {name: sender.report() for name, sender in list(self._senders.items())}

    def lines(self) -> list[str]:
        """Return what is to be known of them at the end, a sentence each."""
        lines = []
        for name, sender in list(self._senders.items()):
            lines += [f"{name}: {line}" for line in sender.defects.lines()]
            unknown = sender.news(math.inf)
            lines += [unknown] if unknown is not None else []
        return lines
