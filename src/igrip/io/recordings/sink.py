"""A file that stays whole: what it held before a failed write is still there after it."""

from __future__ import annotations

import os
from pathlib import Path

from igrip.errors import RecordingError


class Sink:
    """Takes whole records, unbuffered; after an error it ends with the last whole one.

    It has what :class:`mcap.writer.Writer` asks of a stream (``write``, ``tell``, ``flush``), and
    no buffer of its own that could be lost or written twice.

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
        """Write all of it; it has left the process when this returns."""
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
        """Do nothing: nothing waits here."""

    def mark(self) -> None:
        """Note that the file is whole up to here."""
        self._whole = self._written

    def sync(self) -> None:
        """Have the operating system put it on the disk."""
        if not self._file.closed:
            os.fsync(self._file.fileno())

    def cut_back(self) -> None:
        """After a failed write, take off the part of a record that was written of it."""
        self._file.truncate(self._whole)
        self._written = self._whole

    def close(self) -> None:
        """Close the file."""
        self._file.close()
