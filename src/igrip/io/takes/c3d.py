"""Takes from C3D files (www.c3d.org), read by the package ``ezc3d``."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from igrip.errors import DatasetError, requires_extra
from igrip.io.layouts import Layout
from igrip.io.layouts._columns import UNITS
from igrip.io.takes.build import RawBody, build_take
from igrip.io.takes.declared import Declared
from igrip.io.takes.take import Take

BLOCK = 512  # bytes
_KEY = 0x50  # second byte of every C3D file


def is_c3d(path: Path) -> bool:
    """Return whether a file begins as a C3D file does."""
    try:
        with path.open("rb") as file:
            head = file.read(2)
    except OSError:
        return False
    return len(head) == 2 and head[1] == _KEY and 1 < head[0] < 64


def read_c3d(name: str, path: Path, declared: Declared) -> Take:
    """Return the markers (and rotations) of a C3D file.

    Raises
    ------
    MissingExtraError
        If ezc3d is not installed.
    DatasetError
        If the file is damaged, or holds no markers.
    """
    _check_sizes(path)
    with requires_extra("ezc3d", "c3d", "reading C3D files"):
        import ezc3d
    try:
        data = ezc3d.c3d(str(path))
        points = np.asarray(data["data"]["points"], dtype=np.float64)
        settings = data["parameters"]["POINT"]
        rate = float(settings["RATE"]["value"][0])
        unit = str((settings.get("UNITS", {}).get("value") or ["mm"])[0]).strip()
        labels = _labels(settings)
        residuals = np.asarray(data["data"]["meta_points"]["residuals"])[0]
        first = int(data["header"]["points"]["first_frame"])
    except Exception as error:  # the library raises many kinds for damaged files
        raise DatasetError(f"{path}: cannot be read as C3D: {error!s:.200}") from None
    if not points.size or not rate > 0:
        raise DatasetError(f"{path}: holds no markers, or no rate")
    bodies: dict[str, RawBody] = {}
    for k in range(points.shape[1]):
        label = labels[k] if k < len(labels) and labels[k] else f"marker {k + 1}"
        label = label.rpartition(":")[2] or label
        if label.startswith("*"):  # not labelled
            continue
        positions = points[:3, k, :].T.copy()
        if residuals.shape[-1] == len(positions):
            positions[residuals[k] < 0] = np.nan
        while label in bodies:
            label += "'"
        bodies[label] = RawBody("marker", positions)
    layout = Layout("C3D", 0, 0, (), length_unit=UNITS.get(unit.lower(), "mm"), time_unit="s")
    frames = np.arange(points.shape[2])
    frame = (Declared(time_unit="s") | declared).frame(layout)
    numbers = (frames + first + 1).tolist()
    return build_take(name, "C3D", frames / rate, numbers, bodies, frame, zero_is_missing=True)


def _labels(settings: Any) -> list[str]:
    """Return the names of the points; more than 255 go on in LABELS2 and so on."""
    labels: list[str] = []
    for number in range(1, 100):
        part = settings.get("LABELS" if number == 1 else f"LABELS{number}")
        if part is None:
            break
        labels += [str(label).strip() for label in part["value"]]
    return labels


def _check_sizes(path: Path) -> None:
    """Raise an error where the header promises more than the file holds."""
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(BLOCK)
            file.seek(BLOCK * (head[0] - 1) if head else 0)
            parameters = file.read(4)
    except OSError as error:
        raise DatasetError(f"{path}: {error.strerror or error}") from error
    if len(head) < BLOCK or len(parameters) < 4:
        raise DatasetError(f"{path}: is cut off within its header")
    order = ">" if parameters[3] == 86 else "<"  # 84 Intel, 85 DEC, 86 MIPS
    points, analog, first, last = struct.unpack_from(f"{order}4H", head, 2)
    scale = struct.unpack_from(f"{order}f", head, 12)[0]
    start = struct.unpack_from(f"{order}H", head, 16)[0]
    each = 4 if (scale < 0 or parameters[3] == 85) else 2
    frames = last - first + 1
    needed = BLOCK * max(0, start - 1) + frames * (4 * points + analog) * each
    if start < 2 or frames < 1 or not points:
        raise DatasetError(f"{path}: its header names no frames or no points")
    if needed > size + BLOCK:
        raise DatasetError(f"{path}: is cut off: {size} of at least {needed} bytes")
