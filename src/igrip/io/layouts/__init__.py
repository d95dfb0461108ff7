"""Layouts of the tables that motion-capture systems export, recognised by what the files hold.

Each module knows one layout; ``_columns`` finds the columns of any other table. A layout says which
line is the first of the data, what the columns are called, and what the header declares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Protocol

from igrip.io.cells.dialect import Dialect, find_dialect
from igrip.io.cells.lines import Lines
from igrip.registry import Registry

HEAD = 200  # lines among which a header ends
Rows = Sequence[Sequence[str]]
RotationKind = Literal["xyzw", "wxyz", "matrix", "rotvec"] | str
"""Order of a quaternion; ``matrix`` by columns; ``rotvec``; or axes as of scipy, ``XYZ``."""


@dataclass(frozen=True)
class BodyColumns:
    """The columns of one body: a marker, or a rigid body that also turns.

    Attributes
    ----------
    name : str
        Of the body.
    kind : str
        ``marker``, or what the system calls it.
    position : 3 ints
        Columns of x, y, z.
    rotation : sequence of int
        Columns of its rotation, 3, 4 or 9 of them; empty for a marker.
    rotation_kind : str
        What those numbers are, see :data:`RotationKind`.
    degrees : bool
        Whether angles are in degrees.
    """

    name: str
    kind: str
    position: tuple[int, int, int]
    rotation: tuple[int, ...] = ()
    rotation_kind: RotationKind = "xyzw"
    degrees: bool = True


@dataclass(frozen=True)
class Layout:
    """What a header states.

    Attributes
    ----------
    name : str
        For the user, for example ``OptiTrack Motive CSV 1.23``.
    first, stop : int
        Lines of the data: the first, and the one behind the last.
    paths : sequence of sequence of str
        Names of each column, from the top row of the header to the lowest.
    bodies : sequence of BodyColumns
        What moves.
    time, frame : int or None
        The columns of the times and of the frame numbers.
    rate : float or None
        Frames per second [Hz].
    length_unit, time_unit : str or None
        As far as the file declares them.
    up : str or None
        Axis that points upwards, where the system fixes it.
    zero_is_missing : bool
        Whether the system writes zeros where it has lost a body.
    missing : sequence of str
        Further words for a missing number.
    remarks : sequence of str
        For the user.
    """

    name: str
    first: int
    stop: int
    paths: tuple[tuple[str, ...], ...]
    bodies: tuple[BodyColumns, ...] = ()
    time: int | None = None
    frame: int | None = None
    rate: float | None = None
    length_unit: str | None = None
    time_unit: str | None = None
    up: str | None = None
    zero_is_missing: bool = False
    missing: tuple[str, ...] = ()
    remarks: tuple[str, ...] = field(default=())


@dataclass(frozen=True)
class Head:
    """The beginning of a text table.

    Attributes
    ----------
    path : Path
        The file.
    lines : Lines
        All of it.
    dialect : Dialect
        Its separator and decimal mark.
    start, stop : int
        The lines that belong to this table.
    rows : sequence of sequence of str
        Cells of its first lines, without the blanks round them.
    """

    path: Path
    lines: Lines
    dialect: Dialect
    start: int
    stop: int
    rows: Rows


class LayoutFinder(Protocol):
    """Recognises one layout."""

    def __call__(self, head: Head) -> Layout | None:
        """Return what the header says; None where the file has another layout.

        Raises
        ------
        DatasetError
            If it has this layout, but cannot be read by it.
        """
        ...


LAYOUTS: Registry[LayoutFinder] = Registry("layout", "igrip.io.layouts", "igrip.layouts")


def read_head(path: Path, lines: Lines, start: int = 0, stop: int | None = None) -> Head:
    """Return the beginning of a table that stands in a part of a file."""
    stop = len(lines) if stop is None else stop
    sample = [line for _, line in lines.between(start, min(start + HEAD, stop))]
    # lines from the middle and the end: a header may be longer than what it heads
    step = max(1, (stop - start) // 50)
    sample += [lines[index] for index in range(start, stop, step)]
    dialect = find_dialect([line[:20_000] for line in sample])
    rows = [
        [cell.strip().strip('"') for cell in dialect.split(line)]
        for _, line in lines.between(start, min(start + HEAD, stop))
    ]
    return Head(path, lines, dialect, start, stop, rows)


def find_layout(head: Head) -> Layout:
    """Return what the header of a table says, by the layout that recognises it or any other."""
    from igrip.io.layouts._columns import plain_layout
    from igrip.io.layouts._footer import without_footer

    for name in LAYOUTS.names():
        layout = LAYOUTS.get(name)(head)
        if layout is not None:
            break
    else:
        layout = plain_layout(head)
    return replace(layout, stop=without_footer(head, layout))
