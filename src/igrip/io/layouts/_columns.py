"""The header of a table of any layout, and the bodies that its columns name."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from igrip.io.cells.dialect import is_value
from igrip.io.cells.values import is_time
from igrip.io.cells.values import number as number_of
from igrip.io.layouts import BodyColumns, Head, Layout

UNITS = {
    "m": "m", "meter": "m", "meters": "m", "metre": "m", "metres": "m",
    "cm": "cm", "centimeter": "cm", "centimeters": "cm", "centimetre": "cm", "centimetres": "cm",
    "mm": "mm", "millimeter": "mm", "millimeters": "mm", "millimetre": "mm", "millimetres": "mm",
    "in": "in", "inch": "in", "inches": "in",
    "km": "km", "ft": "ft", "foot": "ft", "feet": "ft",
}  # fmt: skip
OTHER_UNITS = frozenset({
    "s", "sec", "ms", "us", "µs", "hz", "deg", "degrees", "°", "rad", "radians", "px", "n", "v",
    "mm/s", "m/s", "mm/s^2", "m/s^2", "deg/s", "rad/s", "n.mm", "n.m", "quat",
})  # fmt: skip
TIME_UNITS = {
    "s": "s", "sec": "s", "secs": "s", "second": "s", "seconds": "s",
    "ms": "ms", "msec": "ms", "milliseconds": "ms", "us": "us", "µs": "us", "microseconds": "us",
    "ns": "ns", "nanoseconds": "ns",
}  # fmt: skip
_TIME = re.compile(
    r"(?:t|times?|time[\s_]?stamps?|(?:elapsed|relative|host|device|unix)(?:[\s_]?time)?|seconds|sec"
    r"|zeit(?:stempel)?|temps|tiempo|tempo|tijd|tid|czas)"
    r"(?:[\s_]*[\[(]?(?P<unit>" + "|".join(TIME_UNITS) + r")[\])]?)?"
)
_LENGTHS = "mm|cm|m|inch|in"
_NAMED_UNIT = re.compile(rf".*[xyz][)\]]?[\s_]*[(\[_]?({_LENGTHS})[)\]]?")
FRAMES = frozenset({
    "frame", "frame#", "frame number", "frames", "frame_number", "framenumber", "frame no",
    "frame_no", "frame_id", "frame_idx", "sample", "index", "bild", "bildnummer",
})  # fmt: skip
_BRACKETS = re.compile(r"[\s_]*[(\[]\s*([xyzw])\s*[)\]]", re.IGNORECASE)  # right[x], right (X)
_COMPONENT = re.compile(
    r"(?P<body>.*?)[\s_.:/|-]*(?:"
    r"(?:pos(?:ition)?|loc(?:ation)?|trans(?:lation)?)?[\s_.:/-]*(?P<position>[tp]?[xyz])"
    rf"(?:\d*|[\s_]*[(\[]?(?:{_LENGTHS})[)\]]?)"
    r"|(?:rot(?:ation)?|ori(?:entation)?|quat(?:ernion)?)[\s_.:/-]*(?P<turn>[xyzw])"
    r"|q[\s_.:-]?(?P<quaternion>[xyzw])"
    r")",
    re.IGNORECASE,
)
_BEFORE = re.compile(
    r"(?:(?:pos(?:ition)?|loc(?:ation)?|trans(?:lation)?)[\s_.:-]+)?"
    r"(?P<position>[xyz])[\s_.:-]+(?P<body>[^\W\d][^()\[\]]*)",
    re.IGNORECASE,
)  # x_hand, pos_x_hand
_WORDS = re.compile(r"[A-Z]?[a-z]{2,}[xyz]|[A-Z]{3,}[XYZ]")  # "index", "matrix": no coordinates


def plain_layout(head: Head) -> Layout:
    """Return the layout of a table with any header, or none."""
    index = _first_data(head)
    names, units = _header(head, index)
    width = max((len(row) for row in head.rows[index : index + 50]), default=0)
    width = max([width, *(len(row) for row in names)])
    paths = _paths(names, width)
    bodies = named_bodies(paths)
    lowered = [path[-1].lower() if path else "" for path in paths]
    time, time_unit = _time_column(lowered, units)
    if time is None:
        time = _clock_column(head.rows[index : index + 50], head.dialect.decimal)
    lengths = {UNITS[unit] for unit in units if unit in UNITS}
    lengths |= {
        UNITS[match[1]] for name in lowered if (match := _NAMED_UNIT.fullmatch(name)) is not None
    }
    return Layout(
        name="table" if names else "table without a header",
        first=head.start + index,
        stop=head.stop,
        paths=paths,
        bodies=bodies,
        time=time,
        frame=next((k for k, name in enumerate(lowered) if name in FRAMES), None),
        length_unit=lengths.pop() if len(lengths) == 1 else None,
        time_unit=time_unit,
    )


def _time_column(names: Sequence[str], units: Sequence[str]) -> tuple[int | None, str | None]:
    """Return the column of times and its unit, as far as the header has them."""
    for k, name in enumerate(names):
        match = _TIME.fullmatch(name)
        if match is not None:
            word = match["unit"] or (units[k] if k < len(units) else "")
            return k, TIME_UNITS.get(word)
    return None, None


def _clock_column(rows: Sequence[Sequence[str]], decimal: str) -> int | None:
    """Return the first column that holds times of day, or dates with times, in all rows."""
    width = min((len(row) for row in rows), default=0)
    for k in range(width):
        cells = [row[k] for row in rows]
        if all(is_time(cell) and number_of(cell, decimal) is None for cell in cells):
            return k
    return None


def named_bodies(paths: Sequence[Sequence[str]]) -> tuple[BodyColumns, ...]:
    """Return the bodies whose x, y and z (and rotation) the columns name."""
    found: dict[str, dict[str, int]] = {}
    for column, path in enumerate(paths):
        component = _component(path)
        if component is not None:
            found.setdefault(component[0], {}).setdefault(component[1], column)
    return tuple(
        body_of(name, columns) for name, columns in found.items() if {"x", "y", "z"} <= set(columns)
    )


def body_of(name: str, columns: Mapping[str, int], kind: str = "marker") -> BodyColumns:
    """Return a body by its columns of x, y, z, and of qx, qy, qz, qw where it has them."""
    x, y, z = (columns[axis] for axis in "xyz")
    quaternion = [columns.get(f"q{axis}") for axis in "xyzw"]
    rotation = tuple(column for column in quaternion if column is not None)
    if len(rotation) == 4:
        return BodyColumns(name, "rigid body", (x, y, z), rotation)
    return BodyColumns(name, kind, (x, y, z))


def _component(path: Sequence[str]) -> tuple[str, str] | None:
    """Return the body and the component (``x``, ``qx``) that the name of a column stands for."""
    if not path:
        return None
    last = _BRACKETS.sub(r" \1", path[-1])
    match = _COMPONENT.fullmatch(last)
    if match is None or _WORDS.fullmatch(last):
        match = _BEFORE.fullmatch(last)  # x_hand
        if match is None or match["body"].lower() in UNITS:
            return None
        return match["body"], match["position"].lower()
    axis = match["position"] or match["turn"] or match["quaternion"]
    above = "/".join(path[:-1])
    turns = match["position"] is None or any("rot" in part.lower() for part in path[:-1])
    body = "/".join(part for part in (_kindless(above), match["body"]) if part)
    return body, ("q" if turns else "") + axis[-1].lower()


def _kindless(name: str) -> str:
    kinds = {"position", "rotation", "orientation", "translation"}
    return "/".join(part for part in name.split("/") if part.lower() not in kinds)


def _first_data(head: Head) -> int:
    """Return the index of the first row of data: rows of numbers, or the second of texts."""
    decimal = head.dialect.decimal
    full = [k for k, row in enumerate(head.rows) if any(row)]
    numbers = {k: _of_numbers(head.rows[k], decimal) for k in full}
    widths = {k: len(head.rows[k]) for k in full}
    values = {
        k: {j for j, cell in enumerate(head.rows[k]) if cell and is_value(cell, decimal)}
        for k in full
    }
    begin = None
    for same_width in (True, False):
        for place in range(len(full)):
            after = full[place : place + 3]
            alike = not same_width or len({widths[j] for j in after}) == 1
            if all(numbers[j] for j in after) and alike:
                begin = place
                break
        if begin is not None:
            # rows of data with fewer numbers may stand above
            while (
                begin
                and values[full[begin - 1]] & values[full[begin]]
                and (widths[full[begin - 1]] == widths[full[begin]])
            ):
                begin -= 1
            return full[begin]
    skip = 1 if full and head.rows[full[0]][0].lower().startswith("sep=") else 0
    return full[skip + 1] if len(full) > skip + 1 else len(head.rows)


def _header(head: Head, index: int) -> tuple[list[list[str]], list[str]]:
    """Return the rows of names above the data, and the row of units (or none)."""
    rows: list[list[str]] = []
    units: list[str] = []
    width = len(head.rows[index]) if index < len(head.rows) else 0
    k = index - 1
    while k >= 0 and not any(head.rows[k]):  # a blank line may stand above the data
        k -= 1
    while k >= 0 and any(head.rows[k]):
        row = [cell.lstrip("#%").strip() for cell in head.rows[k]]
        filled = [cell for cell in row if cell]
        if _of_numbers(row, head.dialect.decimal) and rows:
            break
        spans = len(row) == width > 2  # one name above several columns
        if rows and (len(row) > width + 1 or _setting(filled) or (len(filled) < 2 and not spans)):
            break
        if all(cell.lower().strip("[]()") in UNITS.keys() | OTHER_UNITS for cell in filled):
            units = [cell.lower().strip("[]()") for cell in row]
        elif len(filled) >= min(2, width) or spans or not rows:
            rows.insert(0, row)
        k -= 1
    return rows, units


def _setting(cells: Sequence[str]) -> bool:
    """Return whether a row is a setting and its value, as ``FREQUENCY 100`` is."""
    return (len(cells) == 2 and cells[0].endswith(":")) or cells[0].startswith("sep=")


def _of_numbers(row: Sequence[str], decimal: str) -> bool:
    full = [cell for cell in row if cell.strip()]
    values = sum(is_value(cell, decimal) for cell in full)
    return bool(full) and values >= max(1.0, 0.5 * len(full))


def _paths(rows: Sequence[Sequence[str]], width: int) -> tuple[tuple[str, ...], ...]:
    """Return the names of each column from the rows of a header.

    A name in an upper row also holds for the columns without one on its right.
    """
    if not rows:
        return tuple((f"column {k + 1}",) for k in range(width))
    filled: list[list[str]] = []
    for number, row in enumerate(rows):
        cells = [*row, *[""] * (width - len(row))][:width]
        if number < len(rows) - 1:
            below = rows[number + 1]
            for k in range(1, width):
                named_below = k < len(below) and below[k]
                if not cells[k] and named_below:
                    cells[k] = cells[k - 1]
        filled.append(cells)
    paths = []
    for k in range(width):
        parts = [cells[k] for cells in filled if cells[k]]
        unique = [p for n, p in enumerate(parts) if n == 0 or p != parts[n - 1]]
        paths.append(tuple(unique) or (f"column {k + 1}",))
    return tuple(paths)
