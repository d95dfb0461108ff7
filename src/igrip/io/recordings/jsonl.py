"""Recordings as ``.jsonl``: one message per line, readable even where the end is cut off."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast

import msgspec

from igrip.intention import Intention
from igrip.io.files import CrashSafeFile, RecordingWriter
from igrip.io.recording_reader import RecordingReader, StoredMessage
from igrip.io.recordings import SOURCES, RecordingFormat
from igrip.io.text import read_lines
from igrip.observation import Observation


class JsonlReader(RecordingReader):
    """The observations of a ``.jsonl`` or ``.jsonl.gz`` file, in order; may be iterated again.

    A file that was cut off in the middle of its last line yields everything before the cut;
    :attr:`cut` then says where it was, and a warning is logged.
    """

    def open(self) -> BinaryIO:
        """Open the file from its beginning, decompressed as it is read."""
        file = super().open()
        if file.read(2) == b"\x1f\x8b":
            file.close()
            return cast(BinaryIO, gzip.open(self.path))
        file.seek(0)
        return file

    def stored_messages(self) -> Iterator[StoredMessage]:
        """Yield the lines of the file."""
        number = 0
        with self.open() as file:
            lines = read_lines(file)
            while True:
                try:
                    line = next(lines, None)
                except (EOFError, zlib.error, gzip.BadGzipFile) as error:
                    self.note_cut(f"after line {number}: {error}")
                    return
                if line is None:
                    return
                number = line.number
                data = b"" if line.too_long else line.data
                yield StoredMessage(f"line {number}", data, not line.ended)


class JsonlWriter(RecordingWriter):
    """Write messages to a ``.jsonl`` file; a crash costs at most the line being written.

    Parameters
    ----------
    path : str or Path
        The file; an existing one is replaced.

    Examples
    --------
    >>> with JsonlWriter("reach.jsonl") as file:  # doctest: +SKIP
    ...     file.write(observation)
    """

    def __init__(self, path: str | Path) -> None:
        self._file = CrashSafeFile(path)

    def write(self, message: Observation | Intention, **more: Any) -> None:
        """Append one message; it has left the process when this returns."""
        line = msgspec.json.encode(message.to_dict() | more) if more else message.to_json()
        try:
            self._file.write(line + b"\n")
        except OSError as error:
            raise self._file.failure(error) from error

    def close(self) -> None:
        """Close the file."""
        self._file.close()


SOURCES.register("jsonl")(RecordingFormat(JsonlReader, JsonlWriter))
