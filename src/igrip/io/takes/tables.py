"""Takes from tables: the bodies that the columns name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.column_names import shortened
from igrip.io.layouts import BodyColumns
from igrip.io.tables import Table
from igrip.io.takes.build import RawBody, build_take
from igrip.io.takes.declared import Declared
from igrip.io.takes.take import Take

Array = NDArray[np.float64]
MAX_RATE = 1e5  # Hz


def take_of(name: str, table: Table, declared: Declared) -> Take:
    """Return what a table with named bodies holds.

    Raises
    ------
    DatasetError
        If it has no times or no bodies; the message says what to declare.
    """
    layout = table.layout
    if not layout.bodies:
        raise DatasetError(
            f"{table.path}: no columns of x, y and z were found; it has {shortened(table.columns)}"
        )
    times, of_day = times_of(table, declared)
    bodies = raw_bodies(table, layout.bodies, declared)
    remarks = list(layout.remarks)
    for section in table.sections:
        if len(section.lines()) != len(times):
            remarks.append(f"section {section.layout.name}: has other frames, and was left out")
            continue
        for key, body in raw_bodies(section, section.layout.bodies, declared).items():
            bodies[f"{key} ({body.kind})" if key in bodies else key] = body
    frame = declared.frame(layout)
    if not of_day and _from_rate(table, declared):
        frame = (declared | Declared(time_unit="s")).frame(layout)
        times = times / frame.seconds
    return build_take(
        name, layout.name, times, table.lines(), bodies, frame, layout.zero_is_missing, of_day,
        remarks,
    )  # fmt: skip


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
            "second), or --input-rate"
        )
    if layout.frame is None:
        return np.arange(len(table.lines())) / rate, False
    frames = table.numbers([layout.frame])[:, 0]
    return frames / rate, False


def raw_bodies(
    table: Table, bodies: Sequence[BodyColumns], declared: Declared
) -> dict[str, RawBody]:
    """Return the numbers of bodies, read in one pass over the table."""
    columns = [column for body in bodies for column in (*body.position, *body.rotation)]
    numbers = table.numbers(columns, declared.missing)
    found: dict[str, RawBody] = {}
    start = 0
    for body in bodies:
        middle, end = start + 3, start + 3 + len(body.rotation)
        turns = numbers[:, middle:end] if body.rotation else None
        kind = body.rotation_kind
        if declared.rotations and len(body.rotation) == 3:
            kind = declared.rotations
        elif declared.quaternions and len(body.rotation) == 4 and table.layout.name == "table":
            kind = "xyzw"  # the columns name the components
        name = body.name
        while name in found:
            name += "'"
        found[name] = RawBody(body.kind, numbers[:, start:middle], turns, kind, body.degrees)
        start = end
    return found


def _from_rate(table: Table, declared: Declared) -> bool:
    column = table.layout.time
    return column is None or bool(declared.rate and column == table.layout.frame)
