"""Recordings and live sources, opened by name; one module for each file format."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from igrip.errors import RecordingError, UnknownNameError
from igrip.io.files import RecordingWriter
from igrip.io.frames import DeclaredFrame
from igrip.observation import Observation
from igrip.registry import Registry

Source = Iterable[Observation]
OpenSource = Callable[[str], Source]


@dataclass(frozen=True)
class RecordingFormat:
    """A file format of recordings, registered under the ending of its files.

    Parameters
    ----------
    reader : function
        Open a file for reading. If the recording was cut off, the attribute ``cut`` of what it
        returns says where after an iteration.
        It takes the declared frame of the messages as its second argument.
    writer : function, optional
        Open a file for writing; an existing file is replaced. None: files can only be read.
    """

    reader: Callable[..., Source]
    writer: Callable[[str], RecordingWriter] | None = None

    def __call__(self, path: str, frame: DeclaredFrame | None = None) -> Source:
        """Open a file for reading."""
        return self.reader(path) if frame is None else self.reader(path, frame)


FOLDERS = "ros2"  # the source of folders; it has no ending

# a source of a third party may be any function from the name to observations
SOURCES: Registry[OpenSource] = Registry("source", "igrip.io.recordings", "igrip.sources")


def open_source(name: str | Path, frame: DeclaredFrame | None = None) -> Source:
    """Open a recording or a live source.

    Parameters
    ----------
    name : str or Path
        A file with a known ending, for example ``reach.jsonl`` or, compressed,
        ``reach.jsonl.gz``; or ``scheme:rest``. The name of a format is a scheme too:
        ``jsonl:reach.txt`` reads a file with any ending. A folder may be a
        bag of ROS 2.
    frame : DeclaredFrame, optional
        Frame and units of the messages; of files only.

    Returns
    -------
    iterable of Observation
        In order of time.

    Raises
    ------
    UnknownNameError
        If no source has this ending or scheme; the message lists the valid ones.
    RecordingError
        If a recording cannot be opened.
    """
    compressed = str(name).lower().endswith(".jsonl.gz") and not str(name).startswith("jsonl:")
    source, rest = _find(f"jsonl:{name}" if compressed else name, "source")
    if frame is None or frame.is_default:
        return source(rest)
    if not isinstance(source, RecordingFormat):
        raise RecordingError(f"{name}: the frame of this source cannot be declared")
    return source(rest, frame)


def open_writer(name: str | Path) -> RecordingWriter:
    """Open a file for messages; an existing file is replaced.

    Parameters
    ----------
    name : str or Path
        A file with a known ending, or ``format:file``, for example ``jsonl:/dev/stdout``.

    Raises
    ------
    UnknownNameError
        If no format has this ending; the message lists the valid ones.
    RecordingError
        If the file cannot be opened.
    """
    source, rest = _find(name, "recording format")
    if not isinstance(source, RecordingFormat) or source.writer is None:
        raise RecordingError(f"{name}: this source can only be read")
    return source.writer(rest)


def _find(name: str | Path, family: str) -> tuple[OpenSource, str]:
    """Return the source that a name asks for, and what the source opens."""
    text = str(name)
    known = SOURCES.names()
    scheme, colon, rest = text.partition(":")
    if colon and scheme in known:
        source = SOURCES.get(scheme)
        return source, rest if isinstance(source, RecordingFormat) else text
    if (Path(text) / "metadata.yaml").is_file():
        return SOURCES.get(FOLDERS), text
    ending = Path(text).suffix.lower().removeprefix(".")
    if ending not in known:
        known = tuple(other for other in known if family == "source" or _is_writable(other))
        choices = [f".{other}" for other in known if other != FOLDERS]
        choices += [f"{other}:…" for other in known]
        raise UnknownNameError(family, text, choices)
    return SOURCES.get(ending), text


def _is_writable(name: str) -> bool:
    source = SOURCES.get(name)
    return isinstance(source, RecordingFormat) and source.writer is not None
