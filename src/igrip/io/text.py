"""The text layer of everything that is read: byte order marks, UTF-16 and line ends."""

from __future__ import annotations

import codecs
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

from igrip.errors import IgripError

# the longer marks first: that of UTF-32 begins like that of UTF-16
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32-le"), (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)  # fmt: skip
MAX_LINE = 1 << 20  # characters of one line; the rest of a longer one is skipped
BLOCK = 1 << 16  # bytes that are read at once


class TextError(IgripError, ValueError):
    """A file is not text of the encoding it seems to have."""


class Encoding(NamedTuple):
    """How a text is encoded, and the length of the mark that it begins with [bytes]."""

    name: str
    mark: int


class Line(NamedTuple):
    """One line of a text, without its end.

    Attributes
    ----------
    number : int
        From 1.
    data : bytes
        As UTF-8, without blanks at both ends; cut off at :data:`MAX_LINE`.
    ended : bool
        Whether a line end follows; a line without one may be cut off.
    too_long : bool
        Whether the line was longer than is read.
    """

    number: int
    data: bytes
    ended: bool
    too_long: bool = False


def detect_encoding(head: bytes) -> Encoding:
    """Return the Unicode encoding of a text by its first bytes.

    Without a mark, zeros at nearly every second place show UTF-16 (what is read here is mostly
    ASCII); everything else is UTF-8.
    """
    for mark, name in _MARKS:
        if head.startswith(mark):
            return Encoding(name, len(mark))
    even, odd = (part.count(0) / max(1, len(part)) for part in (head[:64:2], head[1:64:2]))
    if even < 0.2 and odd > 0.7:
        return Encoding("utf-16-le", 0)
    if odd < 0.2 and even > 0.7:
        return Encoding("utf-16-be", 0)
    return Encoding("utf-8", 0)


def decode_text(data: bytes, fallback: str | None = None) -> str:
    """Return the text of a whole file, with plain line feeds as line ends and without its mark.

    Parameters
    ----------
    data : bytes
        The file.
    fallback : str, optional
        Encoding of a text that is not Unicode, for example ``"cp1252"``.

    Raises
    ------
    TextError
        If it is no text; the message names the byte.
    """
    encoding = detect_encoding(data)
    try:
        text = data[encoding.mark :].decode(encoding.name)
    except UnicodeDecodeError as error:
        if fallback is None:
            place = error.start + encoding.mark
            raise TextError(f"byte {place}: is not {encoding.name.upper()}") from None
        text = data.decode(fallback, errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_text(path: str | Path, fallback: str | None = None) -> str:
    """Return the text of a file; see :func:`decode_text`.

    Raises
    ------
    TextError
        If it is no text; the message names the file.
    OSError
        If it cannot be read.
    """
    try:
        return decode_text(Path(path).read_bytes(), fallback)
    except TextError as error:
        raise TextError(f"{path}, {error}") from None


def read_lines(file: BinaryIO, max_length: int = MAX_LINE) -> Iterator[Line]:
    """Yield the lines of a stream as they come; blank ones are counted, not yielded.

    Line ends are a line feed, after a carriage return or not, or a carriage return alone (in lines
    within the limit). Bytes that are no text become the replacement character (those of UTF-8 stay
    as they are), so that one bad line costs itself.
    """
    reader = _LineReader(file, max_length)
    number = 0
    while (line := reader.next()) is not None:
        parts = [line.data] if line.too_long else line.data.rstrip(b"\r\n\0").split(b"\r")
        for index, part in enumerate(parts):
            number += 1
            data = part.strip(b" \t\r\n\0")
            if data:
                ended = line.ended or index < len(parts) - 1 or line.data.endswith(b"\r")
                yield Line(number, data, ended, line.too_long)


class _LineReader:
    """Splits a stream into lines of bounded length, in UTF-8."""

    def __init__(self, file: BinaryIO, max_length: int) -> None:
        self._file, self._limit = file, max_length
        self._encoding: Encoding | None = None
        self._newline, self._first = b"\n", b""

    def next(self) -> Line | None:
        raw = self._raw()
        if self._encoding is None:
            if not raw:
                return None
            self._encoding = detect_encoding(raw)
            self._newline = "\n".encode(self._encoding.name)
            raw = raw[self._encoding.mark :] + self._rest(raw)
        elif not raw:
            return None
        ended = raw.endswith(self._newline)
        too_long = not ended and len(raw) >= self._limit
        while too_long and (rest := self._raw()):  # skip the rest of it
            if rest.endswith(self._newline):
                ended = True
                break
        if self._encoding.name != "utf-8":
            raw = raw.decode(self._encoding.name, errors="replace").encode("utf-8", "replace")
        return Line(0, raw, ended, too_long)

    def _rest(self, raw: bytes) -> bytes:
        """Return what belongs to the first line after its bytes ended with 0x0A."""
        assert self._encoding is not None
        return self._complete(raw[self._encoding.mark :])

    def _raw(self) -> bytes:
        line = self._file.readline(self._limit)
        if self._encoding is None or self._encoding.name == "utf-8":
            return line
        return line + self._complete(line)

    def _complete(self, line: bytes) -> bytes:
        """Return the bytes that complete a line of wide characters, up to a true line end."""
        assert self._encoding is not None
        if self._encoding.name == "utf-8":
            return b""
        width, more = len(self._newline), b""
        while line and len(line) + len(more) < self._limit:
            whole = line + more
            missing = -len(whole) % width
            if missing:
                extra = self._file.read(missing)
            elif whole.endswith(self._newline):
                break
            else:
                extra = self._file.readline(self._limit - len(whole))
            if not extra:
                break
            more += extra
        return more
