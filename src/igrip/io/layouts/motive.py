"""Tables of OptiTrack Motive (CSV export), versions 1.1x to 1.25.

The first line holds pairs of names and values; it can be left out of an export. Rows of the header:
type, name, ID, (parent,) Rotation or Position, and the axes under ``Frame`` and ``Time (Seconds)``.
Motive's world has y up; Euler angles turn about the body's own axes since Motive 1.6
(help.naturalpoint.com, "Changes in Motive's Reported Euler Angles").
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from igrip.errors import DatasetError
from igrip.io.layouts import LAYOUTS, BodyColumns, Head, Layout
from igrip.io.layouts._columns import UNITS

_TYPES = {
    "rigid body": "rigid body", "bone": "bone", "marker": "marker",
    "rigid body marker": "marker", "bone marker": "marker", "trained markerset bone": "bone",
}  # fmt: skip
_SOLVED = ("rigid body marker", "bone marker")  # where a marker should be, not where it was seen


def motive(head: Head) -> Layout | None:
    """Return what the header of a Motive export says."""
    rows = head.rows
    first = next((row for row in rows if any(row)), None)
    if first is None:
        return None
    whole = first[0].lower() == "format version"
    settings = _settings(first) if whole else {}
    axes = next(
        (
            k for k, row in enumerate(rows)
            if k and len(row) > 2 and row[0].lower() == "frame" and row[1].lower()[:4] == "time"
        ),
        None,
    )  # fmt: skip
    if axes is None:
        if not whole:
            return None
        raise DatasetError(
            f"{head.path}: is a Motive export without the row 'Frame, Time (Seconds), X, Y, Z'"
        )
    upper = [row for row in rows[:axes] if any(row) and (row is not first or not whole)]
    width = len(rows[axes])
    types = _row_of(upper, lambda row: any(cell.lower() in _TYPES for cell in row[1:]))
    kinds = _row_of(upper, lambda row: any(cell in ("Position", "Rotation") for cell in row[1:]))
    if types is None or kinds is None:
        if not whole:
            return None
        raise DatasetError(f"{head.path}: its Motive header has no row of types or of 'Position'")
    names = upper[upper.index(types) + 1]
    cells = [_padded(row, width) for row in (types, names, kinds, rows[axes])]
    rotation = settings.get("rotation type", "Quaternion" if whole else "XYZ")
    bodies, unlabelled = _bodies(cells, rotation)
    version = settings.get("format version", "")
    remarks = []
    if not whole:
        remarks.append("its first line, with rate, unit and kind of rotation, was not exported")
    if unlabelled:
        remarks.append(f"{unlabelled} markers without a label are left out")
    unit = settings.get("length units", settings.get("units", ""))
    space = settings.get("coordinate space", "global")
    if space.lower() != "global":
        remarks.append(f"coordinate space is {space!r}: poses of bones refer to their parents")
    paths = tuple(
        tuple(dict.fromkeys(part for part in (cells[1][k], cells[2][k], cells[3][k]) if part))
        or (f"column {k + 1}",)
        for k in range(width)
    )
    return Layout(
        name=f"OptiTrack Motive CSV {version}".strip(),
        first=head.start + axes + 1,
        stop=head.stop,
        paths=paths,
        bodies=bodies,
        time=1,
        frame=0,
        rate=_rate(settings),
        length_unit=UNITS.get(unit.lower()),
        time_unit="s",
        up="y",
        remarks=tuple(remarks),
    )


def _settings(row: Sequence[str]) -> dict[str, str]:
    return {row[k].lower(): row[k + 1] for k in range(0, len(row) - 1, 2)}


def _rate(settings: Mapping[str, str]) -> float | None:
    for name in ("export frame rate", "capture frame rate"):
        try:
            rate = float(settings[name].replace(",", "."))
        except (KeyError, ValueError):
            continue
        if rate > 0:
            return rate
    return None


def _row_of(rows: Sequence[Sequence[str]], wanted) -> Sequence[str] | None:  # type: ignore[no-untyped-def]
    return next((row for row in rows if wanted(row)), None)


def _padded(row: Sequence[str], width: int) -> list[str]:
    return [*row, *[""] * (width - len(row))][:width]


def _bodies(cells: Sequence[Sequence[str]], rotation: str) -> tuple[tuple[BodyColumns, ...], int]:
    """Return the bodies, and how many markers without a label were left out."""
    found: dict[tuple[str, str], dict[str, int]] = {}
    for k in range(2, len(cells[0])):
        type_, name, kind, axis = (row[k] for row in cells)
        if type_.lower() in _TYPES and kind in ("Position", "Rotation") and axis.lower() in "xyzw":
            key = ("r" if kind == "Rotation" else "") + axis.lower()
            found.setdefault((type_.lower(), name), {}).setdefault(key, k)
    measured = {name for type_, name in found if type_ not in _SOLVED}
    bodies: list[BodyColumns] = []
    unlabelled = 0
    for (type_, name), columns in found.items():
        if not {"x", "y", "z"} <= set(columns) or (type_ in _SOLVED and name in measured):
            continue
        if re.match(r"(unlabeled|unlabelled)\b", name, re.IGNORECASE):
            unlabelled += 1
            continue
        position = (columns["x"], columns["y"], columns["z"])
        turn, order = _rotation(columns, rotation)
        bodies.append(BodyColumns(name, _TYPES[type_], position, turn, order))
    return tuple(bodies), unlabelled


def _rotation(columns: Mapping[str, int], rotation: str) -> tuple[tuple[int, ...], str]:
    if {"rx", "ry", "rz", "rw"} <= set(columns):
        return tuple(columns[f"r{axis}"] for axis in "xyzw"), "xyzw"
    order = next(iter(re.findall(r"[XYZ]{3}", rotation.upper())), "XYZ")
    if {"rx", "ry", "rz"} <= set(columns) and len(set(order)) == 3:
        return tuple(columns[f"r{axis.lower()}"] for axis in order), order
    return (), "xyzw"


LAYOUTS.register("motive")(motive)
