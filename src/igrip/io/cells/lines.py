"""The text of a file by lines, decoded by what it holds and not by its name."""

from __future__ import annotations

import codecs
import re
import zlib
from array import array
from collections.abc import Iterator
from pathlib import Path

from igrip.errors import DatasetError

MAX_BYTES = 2**31  # of a table; a day of 50 markers at 100 Hz is less
MAX_RATIO = 100  # a compressed table is no longer than this times its file
_GZIP = b"\x1f\x8b"
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"), (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip


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

    The encoding is that of its byte order mark, else UTF-16 where every second byte is zero, else
    UTF-8, else the Western European code page of Windows.

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
    encoding = find_encoding(data)
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise DatasetError(f"{path}: is no text: {error}") from None
    del data
    if text.count("\0") > 0.01 * len(text):
        raise DatasetError(f"{path}: is no text, it holds zero bytes")
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    return Lines(text, "utf-8" if encoding == "utf-8-sig" else encoding)


def find_encoding(data: bytes) -> str:
    """Return the name of the encoding that the bytes of a text most likely have."""
    for mark, name in _MARKS:
        if data.startswith(mark):
            return name
    head = data[:4096]
    zeros = [head[start::2].count(0) for start in (0, 1)]
    if max(zeros) > 0.4 * (len(head) // 2) > 0:
        return "utf-16-be" if zeros[0] > zeros[1] else "utf-16-le"
    try:
        codecs.utf_8_decode(data, "strict", True)
    except UnicodeDecodeError:
        pass
    else:
        return "utf-8"
    try:
        data.decode("cp1252")
    except UnicodeDecodeError:
        return "latin-1"
    return "cp1252"


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
