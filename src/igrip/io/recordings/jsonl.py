"""Recordings as lines of JSON: written line by line, and read even where the end is cut off."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

import msgspec

from igrip.errors import ObservationError, RecordingError
from igrip.intention import Intention
from igrip.observation import Observation

log = logging.getLogger(__name__)


class JsonlReader:
    """The observations of a ``.jsonl`` file, in order; may be iterated again.

    A file that was cut off in the middle of its last line (a full disk, a killed recorder) yields
    everything before the cut; :attr:`cut` then says where it was, and a warning is logged.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    RecordingError
        If the file cannot be opened; while iterating, if a whole line is malformed (file, line and
        field are named).
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.cut: str | None = None
        if not self.path.exists() or self.path.is_dir():
            what = "is a folder" if self.path.is_dir() else "no such file"
            raise RecordingError(f"{self.path}: {what}")

    def __iter__(self) -> Iterator[Observation]:
        self.cut = None
        last = -1.0
        with _open(self.path) as file:
            for number, line in enumerate(file, start=1):
                text = line.strip(b" \t\r\n\0")
                if not text:
                    continue
                try:
                    observation = Observation.from_json(text)
                    if observation.t < last:
                        raise ObservationError("t", f"decreased from {last!r} to {observation.t!r}")
                except ObservationError as error:
                    if error.field == "message" and not line.endswith(b"\n"):
                        self.cut = f"{self.path}: cut off in line {number}; {number - 1} lines read"
                        log.warning(self.cut)
                        return
                    raise RecordingError(f"{self.path}, line {number}: {error}") from error
                last = observation.t
                yield observation


def _open(path: Path) -> BinaryIO:
    try:
        return path.open("rb")
    except OSError as error:
        raise RecordingError(f"{path}: {error.strerror or error}") from error


class JsonlWriter:
    """Writes messages to a ``.jsonl`` file; a crash costs at most the line being written.

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
        self.path = Path(path)
        try:
            self._file = self.path.open("wb", buffering=0)
        except OSError as error:
            raise RecordingError(f"{self.path}: {error.strerror or error}") from error

    def write(self, message: Observation | Intention, **more: Any) -> None:
        """Append one message; it has left the process when this returns.

        Parameters
        ----------
        message : Observation or Intention
            What to write.
        **more
            Further fields of its line.

        Raises
        ------
        RecordingError
            If the disk is full or fails.
        """
        line = msgspec.json.encode(message.to_dict() | more) if more else message.to_json()
        rest = memoryview(line + b"\n")
        try:
            while rest:
                rest = rest[self._file.write(rest) or 0 :]
        except OSError as error:
            raise RecordingError(
                f"{self.path}: {error.strerror or error}; what was recorded before can be read"
            ) from error

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> JsonlWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
