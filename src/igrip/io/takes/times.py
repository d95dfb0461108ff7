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
