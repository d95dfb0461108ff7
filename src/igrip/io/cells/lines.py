"""The text of a file by lines, decoded by what it holds and not by its name."""

from __future__ import annotations

import re
import zlib
from array import array
from collections.abc import Iterator
from pathlib import Path

from igrip.errors import DatasetError
from igrip.io.text import TextError, decode_text, detect_encoding

MAX_BYTES = 2**31  # of a table; a day of 50 markers at 100 Hz is less
MAX_RATIO = 100  # a compressed table is no longer than this times its file
_GZIP = b"\x1f\x8b"
WESTERN = "cp1252"  # Western European Windows


class Lines:
    """A text by lines, without their ends; holds the text once.

    Parameters
    ----------
    text : str
        Lines end with a line feed.
    encoding : str
        What it was decoded from.
    """

    def __init__(self, text: str, encoding: str = "utf-8") -> None:
        self.encoding = encoding
        self._text = text
        self._ends = array("Q", (match.start() for match in re.finditer("\n", text)))
        if text and not text.endswith("\n"):
            self._ends.append(len(text))

    def __len__(self) -> int:
        return len(self._ends)

    def __getitem__(self, index: int) -> str:
        return self._text[self._ends[index - 1] + 1 if index else 0 : self._ends[index]]

    def between(self, first: int, stop: int) -> Iterator[tuple[int, str]]:
        """Yield the index and text of the lines from ``first`` to before ``stop``."""
        for index in range(first, min(stop, len(self))):
            yield index, self[index]


def read_lines(path: Path) -> Lines:
    """Read a text file, also one compressed by gzip.

    The encoding is one of Unicode, or else the Western European code page of Windows.

    Raises
    ------
    DatasetError
        If it cannot be read, is larger than :data:`MAX_BYTES`, or is no text.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise DatasetError(f"{path}: is larger than {MAX_BYTES / 2**30:g} GiB")
        data = path.read_bytes()
    except OSError as error:
        raise DatasetError(f"{path}: {error.strerror or error}") from error
    if data.startswith(_GZIP):
        data = _decompress(data, path)
    try:
        text = decode_text(data)
        encoding = detect_encoding(data).name
    except TextError:
        encoding = WESTERN
        try:
            text = decode_text(data, fallback=WESTERN)
        except (TextError, UnicodeError) as error:
            raise DatasetError(f"{path}: is no text: {error}") from None
    if text.count("\0") > 0.01 * len(text):
        raise DatasetError(f"{path}: is no text, it holds zero bytes")
    return Lines(text, encoding)


def _decompress(data: bytes, path: Path) -> bytes:
    limit = min(MAX_BYTES, MAX_RATIO * len(data) + 2**20)
    reader = zlib.decompressobj(wbits=31)
    try:
        text = reader.decompress(data, limit)
    except zlib.error as error:
        raise DatasetError(f"{path}: cannot be decompressed: {error}") from None
    if reader.unconsumed_tail:
        raise DatasetError(f"{path}: is more than {MAX_RATIO} times larger when decompressed")
    return text
