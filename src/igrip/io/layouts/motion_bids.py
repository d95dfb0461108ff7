"""Tables of Motion-BIDS: ``*_motion.tsv`` has no header, ``*_channels.tsv`` names its columns.

Channels of the type POS have the components x, y, z of a tracked point; those of the type ORNT are
the quaternion components quat_x to quat_w or Euler angles about x, y, z. The rate stands in
``*_motion.json`` (bids-specification.readthedocs.io, "Motion").
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from igrip.errors import DatasetError
from igrip.io.cells.dialect import is_value
from igrip.io.cells.lines import read_lines
from igrip.io.layouts import LAYOUTS, BodyColumns, Head, Layout
from igrip.io.layouts._columns import UNITS

LEVELS = 4  # folders of a data set in which a file may stand: motion, session, subject, and its own


def motion_bids(head: Head) -> Layout | None:
    """Return what the files beside a ``*_motion.tsv`` say."""
    stem = head.path.name.lower().removesuffix(".gz").removesuffix(".tsv")
    if not stem.endswith("_motion"):
        return None
    channels = _applying(head.path, "_channels.tsv")
    if channels is None:
        return None
    rows = _channels(channels)
    settings = _settings(_applying(head.path, "_motion.json"))
    width = next((len(row) for row in head.rows if any(row)), 0)
    if width != len(rows):
        raise DatasetError(f"{head.path}: has {width} columns, {channels.name} names {len(rows)}")
    named = not any(
        is_value(cell, head.dialect.decimal) for cell in head.rows[0]
    )  # against the rule
    units = {
        UNITS.get(row.get("units", "").lower())
        for row in rows
        if row.get("type", "").upper() == "POS"
    }
    rate = settings.get("SamplingFrequency")
    missing = settings.get("MissingValues")
    latency = [k for k, row in enumerate(rows) if row.get("type", "").upper() == "LATENCY"]
    return Layout(
        name="Motion-BIDS",
        first=head.start + named,
        stop=head.stop,
        paths=tuple((row["name"],) for row in rows),
        bodies=_bodies(rows),
        time=latency[0] if latency else None,
        rate=float(rate) if isinstance(rate, int | float) and rate > 0 else None,
        length_unit=units.pop() if len(units) == 1 else None,
        time_unit="s",
        missing=(str(missing),) if missing is not None else (),
    )


def _bodies(rows: Sequence[Mapping[str, str]]) -> tuple[BodyColumns, ...]:
    positions: dict[str, dict[str, int]] = {}
    turns: dict[str, dict[str, int]] = {}
    degrees: dict[str, bool] = {}
    for k, row in enumerate(rows):
        point = row.get("tracked_point", "")
        component = row.get("component", "").lower()
        kind = row.get("type", "").upper()
        if kind == "POS":
            positions.setdefault(point, {}).setdefault(component, k)
        elif kind == "ORNT":
            turns.setdefault(point, {}).setdefault(component, k)
            degrees[point] = not row.get("units", "").lower().startswith("rad")
    bodies = []
    for name, columns in positions.items():
        if not {"x", "y", "z"} <= set(columns):
            continue
        position = (columns["x"], columns["y"], columns["z"])
        turn = turns.get(name, {})
        quaternion = [turn[f"quat_{axis}"] for axis in "xyzw" if f"quat_{axis}" in turn]
        angles = [turn[axis] for axis in "xyz" if axis in turn]
        if len(quaternion) == 4:
            bodies.append(BodyColumns(name, "rigid body", position, tuple(quaternion), "xyzw"))
        elif len(angles) == 3:
            bodies.append(
                BodyColumns(name, "rigid body", position, tuple(angles), "XYZ", degrees[name])
            )
        else:
            bodies.append(BodyColumns(name, "marker", position))
    return tuple(bodies)


def _channels(path: Path) -> list[dict[str, str]]:
    lines = read_lines(path)
    reader = csv.DictReader((lines[k] for k in range(len(lines))), delimiter="\t")
    if not {"name", "component", "type", "tracked_point"} <= set(reader.fieldnames or ()):
        raise DatasetError(f"{path}: needs the columns name, component, type, tracked_point, units")
    return [
        {key: (row[key] or "").strip() for key in row if isinstance(key, str)} for row in reader
    ]


def _applying(path: Path, ending: str) -> Path | None:
    """Return the file that applies to a recording by BIDS' principle of inheritance.

    It may stand in a folder above, with fewer of the entities; the nearest and most special holds.
    """
    entities = set(path.name.split("_")[:-1])
    for folder in path.resolve().parents[:LEVELS]:
        found = [
            file for file in sorted(folder.glob(f"*{ending}"))
            if set(file.name.removesuffix(ending).split("_")) <= entities
        ]  # fmt: skip
        if found:
            return max(found, key=lambda file: len(file.name))
    return None


def _settings(path: Path | None) -> Mapping[str, Any]:
    if path is None:
        return {}
    lines = read_lines(path)
    try:
        settings = json.loads("\n".join(lines[k] for k in range(len(lines))))
    except ValueError as error:
        raise DatasetError(f"{path}: {error}") from None
    return settings if isinstance(settings, dict) else {}


LAYOUTS.register("motion_bids")(motion_bids)
