"""Recordings on disk, written so that a failure costs little."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any, Self

from igrip.errors import RecordingError
from igrip.intention import Intention
from igrip.observation import Observation


class RecordingWriter(ABC):
    """A recording to which messages are appended; a context manager that closes it."""

    @abstractmethod
    def write(self, message: Observation | Intention, **more: Any) -> None:
        """Append one message, with further fields in its JSON.

        Raises
        ------
        RecordingError
            If the disk is full or fails.
        """

    @abstractmethod
    def close(self) -> None:
        """Finish and close the file."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class CrashSafeFile:
    """A new file for whole records, unbuffered; after an error it ends with the last whole record.

    It has the methods that :class:`mcap.writer.Writer` needs of a stream (``write``, ``tell``,
    ``flush``), and no buffer that could be lost or written twice.

    Parameters
    ----------
    path : str or Path
        The file; an existing one is replaced.

    Raises
    ------
    RecordingError
        If it cannot be opened.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._whole = self._written = 0
        try:
            self._file = self.path.open("wb", buffering=0)
        except OSError as error:
            raise RecordingError(f"{self.path}: {error.strerror or error}") from error

    def write(self, data: bytes) -> int:
        """Write all of the data; it has left the process when this returns."""
        rest = memoryview(data)
        while rest:
            done = self._file.write(rest) or 0
            self._written += done
            rest = rest[done:]
        return len(data)

    def tell(self) -> int:
        """Return how many bytes were written."""
        return self._written

    def flush(self) -> None:
        """Do nothing, since there is no buffer."""

    def mark(self) -> None:
        """Mark the file as whole up to here."""
        self._whole = self._written

    def sync(self) -> None:
        """Have the operating system write the data to the disk."""
        if not self._file.closed:
            os.fsync(self._file.fileno())

    def cut_back(self) -> None:
        """Remove what a failed write left after the last :meth:`mark`."""
        self._file.truncate(self._whole)
        self._written = self._whole

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def failure(self, error: OSError) -> RecordingError:
        """Return the error to raise after a failed write."""
        reason = error.strerror or error
        return RecordingError(f"{self.path}: {reason}; what was recorded before can be read")
