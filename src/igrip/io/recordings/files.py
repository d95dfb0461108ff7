"""Recordings by the ending of their name: ``.jsonl`` and ``.mcap``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self

from igrip.intention import Intention
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.io.recordings.mcap_writer import McapReader, McapWriter
from igrip.observation import Observation

ENDINGS = (".jsonl", ".mcap")


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
    """Open a recording of observations: MCAP where its name ends so, else lines of JSON.

    Raises
    ------
    RecordingError
        If the file cannot be opened.
    """
    return McapReader(path) if _is_mcap(path) else JsonlReader(path)


def open_writer(path: str | Path) -> Writer:
    """Open a file for messages: MCAP where its name ends so, else lines of JSON.

    An existing file is replaced.

    Raises
    ------
    RecordingError
        If the file cannot be opened.
    """
    return McapWriter(path) if _is_mcap(path) else JsonlWriter(path)


def _is_mcap(path: str | Path) -> bool:
    return Path(path).suffix.lower() == ".mcap"
