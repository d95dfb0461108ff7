"""Recordings by the ending of their name: ``.jsonl`` and ``.mcap``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self

from igrip.errors import RecordingError
from igrip.intention import Intention
from igrip.observation import Observation
from igrip.recording.jsonl import JsonlReader, JsonlWriter
from igrip.recording.mcap import McapReader, McapWriter

READERS = {".jsonl": JsonlReader, ".mcap": McapReader}
WRITERS = {".jsonl": JsonlWriter, ".mcap": McapWriter}
ENDINGS = tuple(READERS)


class Reader(Protocol):
    """The observations of a recording, in order; may be iterated again.

    Attributes
    ----------
    cut : str or None
        Where the file was cut off, after an iteration.
    """

    cut: str | None

    def __iter__(self) -> Iterator[Observation]: ...


class Writer(Protocol):
    """Takes messages; a context manager."""

    def write(self, message: Observation | Intention, **more: Any) -> None:
        """Append one message; further fields are added to its JSON."""
        ...

    def close(self) -> None:
        """Finish the file."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...


def open_recording(path: str | Path) -> Reader:
    """Open a recording of observations.

    Raises
    ------
    RecordingError
        If the ending is unknown, or the file cannot be opened.
    """
    reader: Reader = READERS[_ending(path)](path)
    return reader


def open_writer(path: str | Path) -> Writer:
    """Open a file for messages; an existing one is replaced.

    Raises
    ------
    RecordingError
        If the ending is unknown, or the file cannot be opened.
    """
    writer: Writer = WRITERS[_ending(path)](path)
    return writer


def _ending(path: str | Path) -> str:
    ending = Path(path).suffix.lower()
    if ending not in READERS:
        raise RecordingError(f"{path}: must end with {' or '.join(ENDINGS)}")
    return ending
