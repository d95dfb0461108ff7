"""Files of intentions: recordings (.jsonl, .mcap) and tables (.csv, .parquet)."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from igrip.errors import RecordingError, requires_extra
from igrip.intention import Intention
from igrip.io.files import RecordingWriter
from igrip.io.intention_table import columns, rows_of
from igrip.io.recordings import open_writer
from igrip.observation import Observation

ENDINGS = (".jsonl", ".mcap", ".csv", ".parquet")
GROUP = 50_000  # rows of a parquet file that are written together


class CsvWriter(RecordingWriter):
    """Write intentions as the rows of :meth:`igrip.io.intentions.Intentions.to_frame`, as UTF-8.

    Parameters
    ----------
    path : Path
        The file; an existing one is replaced.
    origin : mapping
        ``recording`` and ``targets`` of all, unless a message comes with its own.
    """

    def __init__(self, path: Path, origin: Mapping[str, Any]) -> None:
        self._path, self._origin = path, origin
        try:
            self._file = path.open("w", encoding="utf-8", newline="")
        except OSError as error:
            raise RecordingError(f"{path}: {error.strerror or error}") from error
        self._rows = csv.DictWriter(self._file, list(columns()), extrasaction="ignore")
        self._rows.writeheader()

    def write(self, message: Observation | Intention, **more: Any) -> None:
        """Append the rows of one intention."""
        assert isinstance(message, Intention)
        try:
            self._rows.writerows(rows_of(message, {**self._origin, **more}))
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error

    def close(self) -> None:
        """Close the file."""
        try:
            self._file.close()
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error


class ParquetWriter(RecordingWriter):
    """Write the same rows to a Parquet file, which can be read once it is closed.

    Raises :class:`MissingExtraError` if pyarrow is not installed.
    """

    def __init__(self, path: Path, origin: Mapping[str, Any]) -> None:
        with requires_extra("pyarrow", "tables", "a .parquet file"):
            import pyarrow
            import pyarrow.parquet
        self._arrow, self._path, self._origin = pyarrow, path, origin
        kinds = {float: pyarrow.float64(), str: pyarrow.string()}
        self._schema = pyarrow.schema([(name, kinds[kind]) for name, kind in columns().items()])
        self._waiting: list[dict[str, Any]] = []
        try:
            self._file = pyarrow.parquet.ParquetWriter(path, self._schema)
        except OSError as error:
            raise RecordingError(f"{path}: {error.strerror or error}") from error

    def write(self, message: Observation | Intention, **more: Any) -> None:
        """Append the rows of one intention."""
        assert isinstance(message, Intention)
        self._waiting += rows_of(message, {**self._origin, **more})
        if len(self._waiting) >= GROUP:
            self._flush()

    def close(self) -> None:
        """Write what waits, and finish the file."""
        if self._waiting:
            self._flush()
        self._file.close()

    def _flush(self) -> None:
        table = self._arrow.Table.from_pylist(self._waiting, self._schema)
        self._waiting.clear()
        try:
            self._file.write_table(table)
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error


def open_intention_writer(name: str | Path, **origin: Any) -> RecordingWriter:
    """Open a file for intentions by its ending; an existing file is replaced.

    Parameters
    ----------
    name : str or Path
        A file that ends with .jsonl, .mcap, .csv or .parquet, or ``jsonl:…`` and ``mcap:…``.
    **origin
        ``recording`` and ``targets``, for the tables.

    Raises
    ------
    UnknownNameError
        If the ending is none of these; the message lists them.
    RecordingError
        If the file cannot be opened.
    MissingExtraError
        If the package for it is not installed.
    """
    ending = Path(name).suffix.lower()
    if ending == ".csv":
        return CsvWriter(Path(name), origin)
    if ending == ".parquet":
        return ParquetWriter(Path(name), origin)
    return open_writer(name)
