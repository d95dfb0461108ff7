"""Rows of an evaluation in a file: memory holds where they are, not what they say."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

from igrip.errors import RecordingError

Row = dict[str, Any]


class KeptRows:
    """Rows of trials, a line of JSON each, after a line that names the evaluation.

    A trial is known by its number; all its rows follow each other. The file survives a kill at any
    moment: a last line that is cut short is dropped by :meth:`resume`.

    Parameters
    ----------
    path : Path
        The file; its folder is made.
    header : bytes
        Its first line; a file with another one is of another evaluation and begins anew.
    """

    def __init__(self, path: Path, header: bytes) -> None:
        self._path, self._header = path, header
        self._places: dict[int, tuple[int, int]] = {}  # of a trial's lines: first byte, length

    def __contains__(self, number: object) -> bool:
        return number in self._places

    def resume(self, is_good: Callable[[int, Sequence[Row]], bool]) -> None:
        """Keep the good rows of an earlier run, and forget the others."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        new = self._path.with_name(f".{self._path.name}")
        self._places.clear()
        with new.open("wb") as file:
            file.write(self._header)
            for number, rows in groupby(self._earlier(), itemgetter("row")):
                if is_good(number, kept := list(rows)):
                    self._write(file, number, kept)
        os.replace(new, self._path)

    def add(self, number: int, rows: Sequence[Row]) -> None:
        """Write the rows of a trial.

        Raises
        ------
        RecordingError
            If the file cannot be written.
        """
        try:
            with self._path.open("ab") as file:
                self._write(file, number, rows)
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error

    def read(self, numbers: Iterable[int]) -> Iterator[Row]:
        """Yield the rows of trials, in the order of the numbers."""
        with self._path.open("rb") as file:
            for number in numbers:
                start, length = self._places[number]
                file.seek(start)
                for line in file.read(length).splitlines():
                    yield json.loads(line)

    def _write(self, file: Any, number: int, rows: Sequence[Row]) -> None:
        lines = b"".join(json.dumps(row, allow_nan=False).encode() + b"\n" for row in rows)
        self._places[number] = (file.tell(), len(lines))
        file.write(lines)

    def _earlier(self) -> Iterator[Row]:
        if not self._path.exists():
            return
        with self._path.open("rb") as file:
            if file.readline() != self._header:
                return
            for line in file:
                try:
                    row = json.loads(line)
                except ValueError:
                    return  # it was cut short
                if isinstance(row, dict) and isinstance(row.get("row"), int):
                    yield row
