"""Times and positions of bodies as the columns of a table hold them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.layouts import BodyColumns
from igrip.io.tables import Table
from igrip.io.takes.build import RawBody
from igrip.io.takes.declared import Declared

Array = NDArray[np.float64]
MAX_RATE = 1e5  # Hz
ROTATIONS = {
    "rotvec": "the three numbers of its rotation are taken as axis times angle; Euler angles are "
    'declared by rotations = "XYZ" in a map (about the body\'s axes; "xyz": about the world\'s)',
    "XYZ": "the three numbers of its rotation exceed half a turn together, so they are taken as "
    'Euler angles about the body\'s x, y and z; other orders are declared by rotations = "ZYX" in '
    "a map",
}


def times_of(table: Table, declared: Declared, column: int | None = None) -> tuple[Array, bool]:
    """Return the times of the rows, and whether they are times of day (in seconds).

    Without a column of times, they are the frame numbers divided by the rate [s].

    Raises
    ------
    DatasetError
        If there is neither; the message says what to declare.
    """
    layout = table.layout
    column = layout.time if column is None else column
    if column is not None and not (declared.rate and column == layout.frame):
        return table.times(column), table.is_clock(column)
    rate = declared.rate or layout.rate
    if rate is None or not 0 < rate <= MAX_RATE:
        raise DatasetError(
            f"{table.path}: has no column of times and no rate; declare rate = … (frames per "
            'second), or --input-rate, or name its column of times in a map: t = "…"'
        )
    if layout.frame is None:
        return np.arange(len(table.lines())) / rate, False
    frames = table.numbers([layout.frame])[:, 0]
    return frames / rate, False


def raw_bodies(
    table: Table,
    bodies: Sequence[BodyColumns],
    declared: Declared,
    remarks: list[str] | None = None,
) -> dict[str, RawBody]:
    """Return the numbers of bodies, read in one pass over the table; add remarks on them.

    Three numbers of a rotation that are longer than half a turn are no axis times angle, which
    Vicon's software gives from 0 to 180 degrees: they are angles about x, y and z.
    """
    columns = [column for body in bodies for column in (*body.position, *body.rotation)]
    numbers = table.numbers(columns, declared.missing)
    named = table.layout.name.startswith("table")  # its columns name the components
    found: dict[str, RawBody] = {}
    start = 0
    for body in bodies:
        middle, end = start + 3, start + 3 + len(body.rotation)
        turns = numbers[:, middle:end] if body.rotation else None
        kind = body.rotation_kind
        if declared.rotations and len(body.rotation) == 3:
            kind = declared.rotations
        elif declared.quaternions and len(body.rotation) == 4 and named:
            kind = "xyzw"
        if kind == "rotvec" and turns is not None and not declared.rotations:
            kind = "XYZ" if _longer_than_half_a_turn(turns, body.degrees) else kind
            if remarks is not None:
                remarks.append(f"{body.name}: {ROTATIONS[kind]}")
        name = body.name
        while name in found:
            name += "'"
        found[name] = RawBody(body.kind, numbers[:, start:middle], turns, kind, body.degrees)
        start = end
    return found


def _longer_than_half_a_turn(turns: Array, degrees: bool) -> bool:
    angles = np.deg2rad(turns) if degrees else turns
    angles = angles[(np.abs(angles) <= 4.0 * np.pi).all(axis=1)]  # a damaged number decides nothing
    return bool((np.linalg.norm(angles, axis=1) > 1.01 * np.pi).any())
