"""Marker trajectories of OpenSim and many systems (TRC).

Four rows: the file's type; names of settings, their values; ``Frame# Time`` and the markers, each
above its three columns; X1 Y1 Z1 …; and mostly a blank line.
"""

from __future__ import annotations

from igrip.errors import DatasetError
from igrip.io.cells.dialect import BLANKS
from igrip.io.layouts import LAYOUTS, BodyColumns, Head, Layout
from igrip.io.layouts._columns import UNITS


def trc(head: Head) -> Layout | None:
    """Return what the header of a TRC file says."""
    rows = head.rows
    if not rows or not rows[0] or rows[0][0].lower() != "pathfiletype":
        return None
    names = next((k for k, row in enumerate(rows) if row and row[0].lower().startswith("frame")), 0)
    if not 3 <= names < len(rows) - 1:
        raise DatasetError(f"{head.path}: is a TRC file without the row 'Frame#, Time, …'")
    settings = dict(zip((cell.lower() for cell in rows[1]), rows[2], strict=False))
    axes, markers = list(rows[names + 1]), list(rows[names])
    if head.dialect.separator == BLANKS:  # the empty cells of the header are lost
        axes = ["", "", *axes]
        markers = [*markers[:2], *(cell for name in markers[2:] for cell in (name, "", ""))]
    width = max(len(axes), len(markers))
    current = ""
    paths: list[tuple[str, ...]] = []
    bodies: list[BodyColumns] = []
    for k in range(width):
        name = markers[k] if k < len(markers) else ""
        axis = axes[k] if k < len(axes) else ""
        if k < 2:
            paths.append((name,))
            continue
        if name and name != current:
            current = name
            if k + 2 < width:
                bodies.append(BodyColumns(name, "marker", (k, k + 1, k + 2)))
        paths.append((current, axis) if axis else (current or f"column {k + 1}",))
    first = names + 2 if any(axes) and axes[0] == "" else names + 1
    while first < len(rows) and not any(rows[first]):
        first += 1
    return Layout(
        name="TRC marker trajectories",
        first=head.start + first,
        stop=head.stop,
        paths=tuple(paths),
        bodies=tuple(bodies),
        time=1,
        frame=0,
        rate=_rate(settings.get("datarate", "")),
        length_unit=UNITS.get(settings.get("units", "").lower()),
        time_unit="s",
        zero_is_missing=True,
    )


def _rate(text: str) -> float | None:
    try:
        rate = float(text.replace(",", "."))
    except ValueError:
        return None
    return rate if rate > 0 else None


LAYOUTS.register("trc")(trc)
