"""Names that a user gives to things, in a TOML file: by their shape and colour."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from igrip.errors import IgripError
from igrip.io.text import TextError, read_text
from igrip.objects.catalog import Catalog
from igrip.perception.shapes.look import Look
from igrip.settings import Settings

HEAD = """# Names of things, by their shape and colour. Rename a table to name a thing.
# size: edges of its bounding box, longest first, in metres; colour: red, green, blue, 0 to 255.
"""


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
    if name == "none" or (name in catalog and name not in catalog.put_models):
        raise ValueError(f"{name!r} is taken: choose another name")
    entry = _Entry(**table)
    size = np.sort(np.array(entry.size))[::-1].copy()
    return ThingName(name, Look(size, np.array(entry.colour)))


def write_names(path: str | Path, looks: Mapping[str, Look]) -> None:
    """Write the looks of things, by id, for the user to rename."""
    lines = [HEAD]
    for id, look in looks.items():
        size = ", ".join(f"{edge:.3f}" for edge in look.size)
        colour = ", ".join(f"{channel:.0f}" for channel in look.colour)
        key = id.replace("\\", "\\\\").replace('"', '\\"')
        lines.append(f'["{key}"]\nsize = [{size}]\ncolour = [{colour}]\n')
    Path(path).write_text("\n".join(lines), encoding="utf-8")
