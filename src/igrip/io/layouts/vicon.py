"""One section of a table of Vicon Nexus or Tracker (CSV export): trajectories, segments, objects.

A section is: its title; the rate; names above their columns; ``Frame, Sub Frame, X, Y, Z …`` or
``RX, RY, RZ, TX, TY, TZ``; units; rows. Three numbers of a rotation are taken as the axis times the
angle, which is what Vicon's software exports unless another form is chosen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from igrip.errors import DatasetError
from igrip.io.layouts import LAYOUTS, BodyColumns, Head, Layout
from igrip.io.layouts._columns import UNITS

SECTIONS = {
    "trajectories": "marker", "segments": "segment", "objects": "object",
    "joints": "", "model outputs": "", "devices": "", "events": "",
}  # fmt: skip
"""Titles of sections, and the kind of their bodies; without one they hold no positions."""


def vicon(head: Head) -> Layout | None:
    """Return what the header of a section says."""
    rows = [(k, row) for k, row in enumerate(head.rows) if any(row)]
    if not rows or rows[0][1][0].lower() not in SECTIONS:
        return None
    title = rows[0][1][0]
    axes = next(
        (k for k, row in rows[1:8] if row[0].lower() == "frame" and len(row) > 2), None
    )  # fmt: skip
    if axes is None and not SECTIONS[title.lower()]:  # events have another header
        columns_of_it = tuple((cell or f"column {k + 1}",) for k, cell in enumerate(rows[-1][1]))
        return Layout(f"Vicon CSV ({title})", head.stop, head.stop, columns_of_it)
    if axes is None or axes < 1:
        raise DatasetError(f"{head.path}: its section {title!r} has no row 'Frame, Sub Frame, …'")
    names, parts = head.rows[axes - 1], head.rows[axes]
    units = head.rows[axes + 1] if axes + 1 < len(head.rows) else []
    columns: dict[str, dict[str, int]] = {}
    paths: list[tuple[str, ...]] = []
    current = ""
    known = _names(names)
    for k, part in enumerate(parts):
        current = (names[k] if k < len(names) else "") or current
        name = known.get(current, current)
        if k < 2 or not part or not name:
            paths.append((part or f"column {k + 1}",))
            continue
        columns.setdefault(name, {}).setdefault(part.lower(), k)
        paths.append((name, part))
    kind = SECTIONS[title.lower()]
    bodies = [
        body
        for name, found in columns.items()
        if kind and (body := _body(name, kind, found, units))
    ]
    lengths = {UNITS[cell.lower()] for cell in units if cell.lower() in UNITS}
    first = axes + 1 + (not _number(units[0]) if units else 0)
    return Layout(
        name=f"Vicon CSV ({title})",
        first=head.start + first,
        stop=head.stop,
        paths=tuple(paths),
        bodies=tuple(bodies),
        frame=0,
        rate=_rate([row[0] for _, row in rows[1:3]]),
        length_unit=lengths.pop() if len(lengths) == 1 else "mm",
        time_unit="s",
        zero_is_missing=True,
    )


def _names(cells: Sequence[str]) -> dict[str, str]:
    """Return the bodies' names without their subjects: ``Anna:RWRA`` is ``RWRA``.

    Subjects stay where two have a body of one name.
    """
    full = {}
    for cell in dict.fromkeys(cells):
        text = cell
        for prefix in ("Global Angle ", "Global Position "):
            text = text.removeprefix(prefix)
        full[cell] = text
    short = {}
    for text in dict.fromkeys(full.values()):
        subject, _, name = text.partition(":")
        short[text] = name or subject
    count = Counter(short.values())
    return {cell: short[text] if count[short[text]] == 1 else text for cell, text in full.items()}


def _body(
    name: str, kind: str, columns: Mapping[str, int], units: Sequence[str]
) -> BodyColumns | None:
    moves = [columns.get(f"t{axis}", columns.get(axis)) for axis in "xyz"]
    if any(column is None for column in moves):
        return None
    x, y, z = (column for column in moves if column is not None)
    turns = [columns[f"r{axis}"] for axis in "xyz" if f"r{axis}" in columns]
    if len(turns) < 3:
        return BodyColumns(name, kind, (x, y, z))
    if "rw" in columns:
        return BodyColumns(name, kind, (x, y, z), (*turns, columns["rw"]), "xyzw")
    unit = units[turns[0]].lower() if turns[0] < len(units) else "deg"
    return BodyColumns(name, kind, (x, y, z), tuple(turns), "rotvec", not unit.startswith("rad"))


def _rate(cells: Sequence[str]) -> float | None:
    for cell in cells:
        if _number(cell) and float(cell.replace(",", ".")) > 0:
            return float(cell.replace(",", "."))
    return None


def _number(text: str) -> bool:
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


LAYOUTS.register("vicon")(vicon)
