"""What is learned of a person, in one small file that they can read, carry, keep or delete."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec

from igrip.adaptation import AdaptationConfig, Person
from igrip.errors import IgripError

FORMAT = "igrip-person/1"


class PersonFileError(IgripError):
    """A file of a person that cannot be read or written."""


class _Stored(msgspec.Struct, forbid_unknown_fields=True):
    format: str
    margin: float
    reaches: int
    wrong: int


class PersonFile:
    """The file of one person.

    Parameters
    ----------
    path : Path
        Of the file; it is made when there is something to keep.
    config : AdaptationConfig
        Its bounds hold for what is read, too.

    Attributes
    ----------
    person : Person
        What is known of them: of a new person nothing.

    Raises
    ------
    PersonFileError
        If there is a file that is not one of a person.
    """

    def __init__(self, path: Path, config: AdaptationConfig | None = None) -> None:
        self.path = path
        self.person = _read(path, config or AdaptationConfig()) if path.exists() else Person()
        self._kept = self.person.reaches

    def keep(self) -> None:
        """Write what was learned since the last time; whoever reads meanwhile gets a whole file.

        Raises
        ------
        PersonFileError
            If it cannot be written.
        """
        if self.person.reaches == self._kept:
            return
        stored = _Stored(FORMAT, **msgspec.structs.asdict(self.person))
        text = msgspec.json.format(msgspec.json.encode(stored), indent=1) + b"\n"
        new = self.path.with_name(f"{self.path.name}.new")
        try:
            new.write_bytes(text)
            os.replace(new, self.path)
        except OSError as error:
            raise PersonFileError(f"{self.path}: {error.strerror or error}") from error
        self._kept = self.person.reaches


def _read(path: Path, config: AdaptationConfig) -> Person:
    try:
        stored = msgspec.json.decode(path.read_bytes(), type=_Stored)
    except OSError as error:
        raise PersonFileError(f"{path}: {error.strerror or error}") from error
    except msgspec.DecodeError as error:
        raise PersonFileError(
            f"{path}: is not the file of a person ({error}); delete it to start again"
        ) from None
    if stored.format != FORMAT:
        raise PersonFileError(f"{path}: its format is {stored.format!r:.40}, not {FORMAT!r}")
    if not 0 <= stored.wrong <= stored.reaches:
        raise PersonFileError(f"{path}: {stored.wrong} wrong ones of {stored.reaches} reaches")
    margin = min(max(stored.margin, -config.max_fall), config.max_rise)
    return Person(margin, stored.reaches, stored.wrong)
