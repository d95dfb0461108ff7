"""What happened in one participant's session: one line an event, on the disk before it counts."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from igrip.experiment.study import StudyError
from igrip.io.whole_files import sync_folder


def local_time() -> str:
    """Return the time of day with its offset from UTC."""
    return datetime.now().astimezone().isoformat(timespec="milliseconds")


class Journal:
    """An append-only file of events, JSON lines; nothing in it is ever changed.

    A line that a power cut tore is cut off when the file is opened again.

    Parameters
    ----------
    path : Path
        The file; it is made where it does not exist, in a folder that does.
    now : function
        Returns the time that stands in each event.

    Attributes
    ----------
    events : list of mapping
        All events, each with ``event`` and ``at``.
    torn : int
        Bytes that were cut off.

    Raises
    ------
    StudyError
        If a line before the last is damaged: what was recorded is then not known for sure.
    """

    def __init__(self, path: Path, now: Callable[[], str] = local_time) -> None:
        self.path, self._now = path, now
        self.events, whole = _read(path)
        self.torn = (path.stat().st_size if path.exists() else 0) - whole
        self._file = open(path, "r+b" if path.exists() else "w+b", buffering=0)  # noqa: SIM115
        self._file.truncate(whole)
        self._file.seek(whole)
        sync_folder(path.parent)

    def add(self, event: str, **fields: Any) -> None:
        """Append an event; when this returns, it is on the disk.

        Raises
        ------
        OSError
            If the disk is full or fails; the event has then not happened.
        """
        entry = {"event": event, "at": self._now(), **fields}
        line = json.dumps(entry, ensure_ascii=False, allow_nan=False).encode() + b"\n"
        before = self._file.tell()
        try:
            if self._file.write(line) != len(line):
                raise OSError(28, os.strerror(28))
            os.fsync(self._file.fileno())
        except OSError:
            self._file.truncate(before)
            self._file.seek(before)
            raise
        self.events.append(entry)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def read_events(path: Path) -> list[Mapping[str, Any]]:
    """Return the events of a journal without opening it for more.

    Raises
    ------
    StudyError
        If a line before the last is damaged.
    """
    return _read(path)[0]


def _read(path: Path) -> tuple[list[Mapping[str, Any]], int]:
    """Return the events, and how many bytes they take: a torn last line is left out."""
    data = path.read_bytes() if path.exists() else b""
    whole = data[: data.rfind(b"\n") + 1]
    events: list[Mapping[str, Any]] = []
    for number, line in enumerate(whole.splitlines(), start=1):
        try:
            event = json.loads(line)
            events.append({"event": event["event"], "at": event["at"], **event})
        except (ValueError, KeyError, TypeError):
            raise StudyError(
                f"{path}, line {number}: is damaged; restore the file from a backup"
            ) from None
    return events, len(whole)
