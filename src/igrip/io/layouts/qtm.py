"""Tables of Qualisys Track Manager (TSV export): markers (3D) and rigid bodies (6D).

With its header, the file begins with settings, one a line (docs.qualisys.com, "Motion data
(.tsv)"). A rigid body has X, Y, Z, Roll, Pitch, Yaw, Residual and the rotation matrix, column by
column, as Rot[0] to Rot[8]. Roll, pitch and yaw turn about the body's own x, y and z axes
("Rotation angles in QTM"). Lengths are millimetres; zeros stand for a body that was lost.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from igrip.errors import DatasetError
from igrip.io.cells.dialect import is_value
from igrip.io.layouts import LAYOUTS, BodyColumns, Head, Layout

_SETTINGS = ("NO_OF_FRAMES", "NO_OF_MARKERS", "NO_OF_BODIES", "MARKER_NAMES", "BODY_NAMES",
             "DATA_INCLUDED", "TIME_STAMP", "NO_OF_CAMERAS", "FREQUENCY")  # fmt: skip
_MATRIX = [f"rot[{k}]" for k in range(9)]
_ANGLES = ("roll", "pitch", "yaw")


def qtm(head: Head) -> Layout | None:
    """Return what the header of a QTM export says."""
    rows = head.rows
    settings: dict[str, Sequence[str]] = {}
    for row in rows:
        if row and re.fullmatch(r"[A-Z][A-Z0-9_]{3,}", row[0]):
            settings.setdefault(row[0], row[1:])
    if len(settings.keys() & set(_SETTINGS)) < 3:
        return _without_settings(head)
    last = max(k for k, row in enumerate(rows) if row and row[0] in settings)
    names = [name for name in settings.get("BODY_NAMES", settings.get("MARKER_NAMES", ())) if name]
    index = last + 1
    while index < len(rows) and not any(rows[index]):
        index += 1
    header: Sequence[str] = ()
    if index < len(rows) and not _of_numbers(rows[index], head):
        header, index = rows[index], index + 1
    width = len(rows[index]) if index < len(rows) else len(header)
    six = any(cell.upper().startswith("6D") for cell in settings.get("DATA_INCLUDED", ()))
    if not header:
        header = _default_header(names, width, six)
    if not header:
        raise DatasetError(
            f"{head.path}: is a QTM export with {len(names)} names for {width} columns; export it "
            "with the column header"
        )
    return _layout(head, head.start + index, header, names, _rate(settings.get("FREQUENCY", ())))


def _without_settings(head: Head) -> Layout | None:
    """Return the layout of a 6D export with a row of names alone."""
    for k, row in enumerate(head.rows[:3]):
        lowered = [cell.lower().split()[-1] if cell else "" for cell in row]
        if {"roll", "pitch", "yaw", "residual"} <= set(lowered) or "rot[8]" in lowered:
            return _layout(head, head.start + k + 1, row, (), None)
    return None


def _layout(
    head: Head, first: int, header: Sequence[str], names: Sequence[str], rate: float | None
) -> Layout:
    columns: dict[str, dict[str, int]] = {}
    paths: list[tuple[str, ...]] = []
    given = iter(names)
    current = ""
    for k, cell in enumerate(header):
        body, component = _component(cell)
        if component == "x" and not body:  # the names stand in the settings alone
            body = next(given, f"body {len(columns) + 1}")
        current = body or current
        if component:
            columns.setdefault(current, {}).setdefault(component, k)
            paths.append((current, cell.split()[-1]) if current != cell else (cell,))
        else:
            paths.append((cell or f"column {k + 1}",))
    bodies = [
        _body(name, found) for name, found in columns.items() if {"x", "y", "z"} <= set(found)
    ]
    lowered = [cell.lower() for cell in header]
    return Layout(
        name=f"Qualisys QTM TSV ({'6D' if any(b.rotation for b in bodies) else '3D'})",
        first=first,
        stop=head.stop,
        paths=tuple(paths),
        bodies=tuple(bodies),
        time=lowered.index("time") if "time" in lowered else None,
        frame=lowered.index("frame") if "frame" in lowered else None,
        rate=rate,
        length_unit="mm",
        time_unit="s",
        zero_is_missing=True,
    )


def _component(cell: str) -> tuple[str, str]:
    """Return the body that a column names (or nothing) and its component (or nothing)."""
    body, _, last = cell.rpartition(" ")
    last = last.lower()
    if last in ("x", "y", "z", *_ANGLES, *_MATRIX):
        return body.strip(), last
    match = re.fullmatch(r"(.+?)[_.:]([xyz])", cell, re.IGNORECASE)
    return (match[1], match[2].lower()) if match else ("", "")


def _body(name: str, columns: Mapping[str, int]) -> BodyColumns:
    position = (columns["x"], columns["y"], columns["z"])
    if set(_MATRIX) <= set(columns):
        rotation = tuple(columns[component] for component in _MATRIX)
        return BodyColumns(name, "rigid body", position, rotation, "matrix")
    if set(_ANGLES) <= set(columns):
        angles = tuple(columns[angle] for angle in _ANGLES)
        return BodyColumns(name, "rigid body", position, angles, "XYZ")
    return BodyColumns(name, "marker", position)


def _default_header(names: Sequence[str], width: int, six: bool) -> Sequence[str]:
    """Return the names of the columns, where the row of names is left out."""
    each = ["X", "Y", "Z"]
    if six:
        each += ["Roll", "Pitch", "Yaw", "Residual", *(f"Rot[{k}]" for k in range(9))]
    for first in ([], ["Frame", "Time"], ["Time"]):
        if names and width == len(first) + len(each) * len(names):
            return [*first, *(f"{name} {part}" for name in names for part in each)]
    return ()


def _rate(values: Sequence[str]) -> float | None:
    try:
        rate = float(values[0].replace(",", "."))
    except (IndexError, ValueError):
        return None  # EXT: the frequency of an outer clock
    return rate if rate > 0 else None


def _of_numbers(row: Sequence[str], head: Head) -> bool:
    full = [cell for cell in row if cell]
    return sum(is_value(cell, head.dialect.decimal) for cell in full) >= 0.5 * len(full)


LAYOUTS.register("qtm")(qtm)
