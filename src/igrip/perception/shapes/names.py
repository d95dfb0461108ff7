"""Names that a user gives to things, in a TOML file: by their shape and colour."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from igrip.errors import IgripError
from igrip.io.text import TextError, read_text
from igrip.io.whole_files import write_whole
from igrip.objects.catalog import Catalog
from igrip.perception.shapes.look import Look
from igrip.settings import Settings

HEAD = """# Names of things, by their shape and colour. Rename a table to name a thing.
# size: edges of its bounding box, longest first, in metres; colour: red, green, blue, 0 to 255.
"""
MAX_LENGTH = 60  # characters of a name that is given on the page
UNNAMED = re.compile(r"object_[0-9]+")


class ThingName(NamedTuple):
    """A name, and what the thing looks like."""

    name: str
    look: Look


class _Entry(Settings):
    size: tuple[float, float, float]
    colour: tuple[float, float, float]


def read_names(path: str | Path, catalog: Catalog) -> tuple[ThingName, ...]:
    """Return the names in a file; none if it does not exist.

    Raises
    ------
    IgripError
        If it cannot be read, or a name is that of a model of the catalogue.
    """
    if not Path(path).exists():
        return ()
    try:
        tables = tomllib.loads(read_text(Path(path)))
        return tuple(_name(name, table, catalog) for name, table in tables.items())
    except (OSError, TextError, ValueError, TypeError) as error:
        raise IgripError(f"{path}: cannot be read: {error}") from error


def _name(name: str, table: Any, catalog: Catalog) -> ThingName:
    if name == "none" or _is_taken(name, catalog):
        raise ValueError(f"{name!r} is taken: choose another name")
    entry = _Entry(**table)
    size = np.sort(np.array(entry.size))[::-1].copy()
    return ThingName(name, Look(size, np.array(entry.colour)))


def give_name(
    path: str | Path, id: str, name: str, look: Look, catalog: Catalog
) -> None:  # fmt: skip
    """Put a name for a look into a file, or replace what it was called there.

    Parameters
    ----------
    path : str or Path
        The file; made if missing.
    id : str
        What the thing was called so far; an entry of this name goes if it has such a look.
    name : str
        Its new name.
    look : Look
        What it looks like.
    catalog : Catalog
        Its models have names of their own.

    Raises
    ------
    IgripError
        If it cannot be a name, another thing has it, or the file cannot be read or written.
    """
    name = " ".join(name.split())
    if not name or len(name) > MAX_LENGTH or not name.isprintable():
        raise IgripError(f"a name has 1 to {MAX_LENGTH} characters")
    if name == "none" or UNNAMED.fullmatch(name) or _is_taken(name, catalog):
        raise IgripError(f"{name!r} is taken: choose another name")
    looks = {one.name: one.look for one in read_names(path, catalog)}
    if name in looks and not looks[name].is_like(look):
        raise IgripError(f"another thing is called {name!r}: choose another name")
    if id in looks and looks[id].is_like(look):
        del looks[id]
    looks[name] = look
    try:
        write_whole(Path(path), _text(looks))
    except OSError as error:
        raise IgripError(f"{path}: cannot be written: {error.strerror}") from error


def _is_taken(name: str, catalog: Catalog) -> bool:
    return name in catalog and name not in catalog.put_models


def write_names(path: str | Path, looks: Mapping[str, Look]) -> None:
    """Write the looks of things, by id, for the user to rename."""
    write_whole(Path(path), _text(looks))


def _text(looks: Mapping[str, Look]) -> str:
    lines = [HEAD]
    for id, look in looks.items():
        size = ", ".join(f"{edge:.3f}" for edge in look.size)
        colour = ", ".join(f"{channel:.0f}" for channel in look.colour)
        key = id.replace("\\", "\\\\").replace('"', '\\"')
        lines.append(f'["{key}"]\nsize = [{size}]\ncolour = [{colour}]\n')
    return "\n".join(lines)
