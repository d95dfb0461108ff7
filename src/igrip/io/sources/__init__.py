"""What a source is: something that yields observations; found by the ending or scheme of a name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from igrip.errors import UnknownNameError
from igrip.observation import Observation
from igrip.registry import Registry

Source = Iterable[Observation]
SOURCES: Registry[Callable[[str], Source]] = Registry("source", "igrip.io.sources", "igrip.sources")


def open_source(name: str | Path) -> Source:
    """Open a recording or a live source.

    Parameters
    ----------
    name : str or Path
        A file such as ``reach.jsonl``, known by its ending, or ``scheme:rest``.

    Returns
    -------
    iterable of Observation
        In order of time.

    Raises
    ------
    UnknownNameError
        If no source knows the ending or scheme.
    RecordingError
        If a recording cannot be opened.
    """
    text = str(name)
    scheme, colon, _ = text.partition(":")
    if colon and scheme in SOURCES.names():
        return SOURCES.get(scheme)(text)
    ending = Path(text).suffix.lower().removeprefix(".")
    if ending not in SOURCES.names():
        raise UnknownNameError("source", ending or text, SOURCES.names())
    return SOURCES.get(ending)(text)
