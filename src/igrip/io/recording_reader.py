"""Recordings on disk, opened for reading: what is damaged costs itself and is named."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from igrip.errors import ObservationError, RecordingError
from igrip.io.defects import Defect, DefectCounts
from igrip.io.first_contact import MESSAGES, FirstContact
from igrip.io.frames import DeclaredFrame
from igrip.io.message_reader import MessageReader, decode_json
from igrip.io.plausibility import options_that_fix, refusal
from igrip.io.timeline import Placed, order_times
from igrip.observation import Observation

log = logging.getLogger(__name__)

EXAMPLE = '{"t": 0.0, "hands": {"right": {"position": [0.1, 0.3, 0.05]}}}'


class StoredMessage(NamedTuple):
    """One message of a file, not yet understood.

    Attributes
    ----------
    place : str
        Where it is, such as ``line 3``.
    content : bytes or mapping
        JSON, or a message that was decoded already.
    may_be_cut : bool
        Whether it is at the end of the file, without an end mark.
    """

    place: str
    content: Any
    may_be_cut: bool = False


class RecordingReader(ABC):
    """A recording on disk; the base of its readers.

    Entities that cannot be understood are not seen, messages that cannot be are left out, and times
    out of order are repaired: :attr:`defects` counts it all, with the first place of each. Numbers
    that cannot be meant so (milliseconds for seconds, millimetres for metres) are refused.

    Parameters
    ----------
    path : str or Path
        The file.
    frame : DeclaredFrame, optional
        Frame and units of the messages.

    Attributes
    ----------
    cut : str or None
        Where the file was cut off (a full disk, a killed recorder) or damaged, after an iteration.
    defects : DefectCounts
        What was wrong with messages, after an iteration.
    remarks : list of str
        What is unusual about the numbers.
    shift : float
        Added to all times, since they begin below zero [s].

    Raises
    ------
    RecordingError
        If there is no such file; while iterating, if it cannot be read, if nothing in it can be
        understood or its numbers are refused. The message names the place in the file.
    """

    may_be_folder = False

    def __init__(self, path: str | Path, frame: DeclaredFrame | None = None) -> None:
        self.path = Path(path)
        self._frame = frame or DeclaredFrame()
        self._begin()
        is_folder = self.path.is_dir() and not self.may_be_folder
        if not self.path.exists() or is_folder:
            problem = "is a folder" if is_folder else "no such file"
            raise RecordingError(f"{self.path}: {problem}")

    def _begin(self) -> None:
        self.cut: str | None = None
        self.defects, self.remarks = DefectCounts(), list[str]()
        self.shift = 0.0

    @abstractmethod
    def stored_messages(self) -> Iterator[StoredMessage]:
        """Yield the messages of the file, in its order."""

    def open(self) -> BinaryIO:
        """Open the file from its beginning."""
        try:
            return self.path.open("rb")
        except OSError as error:
            raise RecordingError(f"{self.path}: {error.strerror or error}") from error

    def note_cut(self, place: str, what: str = "cut off") -> None:
        """Set :attr:`cut`, unless it is set, and log it as a warning."""
        text = f"{self.path}: {what} {place}"
        log.warning(text)
        self.cut = self.cut or text

    def __iter__(self) -> Iterator[Observation]:
        self._begin()
        contact, waiting = FirstContact(self._frame), list[Observation]()
        open_yet = False  # whether the first messages were checked
        for _, observation in order_times(self._decoded(), self.defects.add):
            if open_yet:
                yield observation
                continue
            waiting.append(observation)
            contact.add(observation)
            if len(waiting) >= MESSAGES:
                open_yet = True
                self._judge(contact)
                yield from waiting
        if not open_yet:
            self._judge(contact)
            yield from waiting

    def _judge(self, contact: FirstContact) -> None:
        findings = contact.check()
        problem = refusal(findings)
        if problem is not None:
            options = options_that_fix(findings)
            hint = f" If so, declare it: {options}" if options else ""
            raise RecordingError(f"{self.path}: {problem}{hint}")
        self.remarks += [finding.text for finding in findings]

    def _decoded(self) -> Iterator[Placed]:
        """Yield the messages that can be understood."""
        reader = MessageReader(self._frame)
        read, first = 0, None
        for stored in self.stored_messages():
            try:
                content = stored.content
                raw = decode_json(content) if isinstance(content, bytes) else content
                observation, defects = reader.read(raw)
            except ObservationError as error:
                if error.field == "message" and stored.may_be_cut:
                    self.note_cut(f"in {stored.place}; {read} messages read")
                    break
                first = first or f"{stored.place}: {error}"
                self.defects.add(Defect("skipped", "messages", str(error)), stored.place)
                continue
            for defect in defects:
                self.defects.add(defect, stored.place)
            self.shift, read = reader.shift, read + 1
            yield stored.place, observation
        if (
            not read and first is None and len(self.defects)
        ):  # of the format, not of igrip's messages
            raise RecordingError(f"{self.path}: {'; '.join(self.defects.lines())}")
        if not read and first is not None:
            raise RecordingError(
                f"{self.path}, {first}. No message of the file can be read; each must be like "
                f"{EXAMPLE}"
            )
