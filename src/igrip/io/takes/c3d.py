"""Takes from C3D files (www.c3d.org, "The C3D file format").

They are read here and not by a library, since damaged files make ``ezc3d`` 1.7 run forever. The
tests compare with it.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.layouts import Layout
from igrip.io.layouts._columns import UNITS
from igrip.io.takes.build import RawBody, build_take
from igrip.io.takes.declared import Declared
from igrip.io.takes.take import Take

Array = NDArray[np.float64]
BLOCK = 512  # bytes
MAX_BYTES = 2**31
_KEY = 0x50  # second byte of every C3D file
_INTEL, _DEC, _MIPS = 84, 85, 86  # kinds of numbers, the fourth byte of the parameters
_MAX_FRAMES = 65535  # that the header can count


@dataclass(frozen=True)
class _Parameter:
    """One parameter: its type (-1: text, 1, 2: integers, 4: floats), dimensions and bytes."""

    kind: int
    dimensions: tuple[int, ...]
    data: bytes


def is_c3d(path: Path) -> bool:
    """Return whether a file begins as a C3D file does."""
    try:
        with path.open("rb") as file:
            head = file.read(2)
    except OSError:
        return False
    return len(head) == 2 and head[1] == _KEY and 1 < head[0] < 64


def read_c3d(name: str, path: Path, declared: Declared) -> Take:
    """Return the markers of a C3D file.

    Raises
    ------
    DatasetError
        If the file is damaged, or holds no markers.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise DatasetError(f"{path}: is larger than {MAX_BYTES / 2**30:g} GiB")
        data = path.read_bytes()
    except OSError as error:
        raise DatasetError(f"{path}: {error.strerror or error}") from error
    file = _C3d(path, data)
    labels = file.labels()
    bodies: dict[str, RawBody] = {}
    for k, positions in enumerate(np.moveaxis(file.points(), 1, 0)):
        label = labels[k] if k < len(labels) else ""
        if label.startswith("*"):  # not labelled
            continue
        label = label.rpartition(":")[2] or label or f"marker {k + 1}"
        while label in bodies:
            label += "'"
        bodies[label] = RawBody("marker", positions)
    if not bodies:
        raise DatasetError(f"{path}: holds no labelled markers")
    unit = (file.texts("UNITS") or ["mm"])[0]
    layout = Layout("C3D", 0, 0, (), length_unit=UNITS.get(unit.lower(), "mm"), time_unit="s")
    frame = (Declared(time_unit="s") | declared).frame(layout)
    frames = np.arange(file.frames)
    numbers = (frames + file.first).tolist()
    times = frames / file.rate
    return build_take(name, "C3D", times, numbers, bodies, frame, zero_is_missing=True)


class _C3d:
    """The header, parameters and points of a file."""

    def __init__(self, path: Path, data: bytes) -> None:
        self._path, self._data = path, data
        begin = BLOCK * (data[0] - 1) if data else 0
        if len(data) < BLOCK or len(data) < begin + 4:
            raise self._cut("within its header")
        self._numbers = data[begin + 3]
        self._order = ">" if self._numbers == _MIPS else "<"
        blocks = data[begin + 2]
        stop = begin + BLOCK * blocks if blocks else len(data)
        self._parameters = _read_parameters(data[begin + 4 : stop], self._order)
        points, analog, first, last = struct.unpack_from(f"{self._order}4H", data, 2)
        self.first = first
        self._points, self._analog = points, analog
        self._scale = self._float(data[12:16])
        self._start = struct.unpack_from(f"{self._order}H", data, 16)[0]
        self.rate = self._value("RATE", self._float(data[20:24]))
        self.frames = last - first + 1
        counted = self._value("FRAMES", 0.0)
        if last >= _MAX_FRAMES and counted > self.frames:
            self.frames = int(counted)
        if self._start < 2 or self.frames < 1 or not points:
            raise DatasetError(f"{path}: its header names no frames or no points")
        if not 0.0 < self.rate < 1e6:
            raise DatasetError(f"{path}: its rate is {self.rate:g} frames per second")

    def points(self) -> Array:
        """Return the positions of all points, shape (frames, points, 3); NaN where lost."""
        floats = self._scale < 0
        width = 4 if floats else 2
        each = 4 * self._points + self._analog
        begin = BLOCK * (self._start - 1)
        needed = self.frames * each * width
        if begin + needed > len(self._data):
            # the last block may be cut short by programs that do not fill it
            raise self._cut(f"after {len(self._data)} of {begin + needed} bytes")
        if floats:
            raw = self._floats(self._data[begin : begin + needed])
        else:
            raw = np.frombuffer(self._data, f"{self._order}i2", self.frames * each, begin)
        rows = raw.reshape(self.frames, each)[:, : 4 * self._points]
        parts = rows.reshape(self.frames, self._points, 4)
        with np.errstate(invalid="ignore"):  # damaged numbers become NaN
            positions = parts[:, :, :3].astype(np.float64)
        if not floats:
            positions *= abs(self._scale)
        positions[(parts[:, :, 3] < 0) | ~np.isfinite(parts[:, :, 3])] = np.nan
        return positions

    def labels(self) -> list[str]:
        """Return the names of the points; more than 255 go on in LABELS2 and so on."""
        labels: list[str] = []
        for number in range(1, 300):
            part = self.texts("LABELS" if number == 1 else f"LABELS{number}")
            if not part:
                break
            labels += part
        return labels

    def texts(self, name: str) -> list[str]:
        """Return a parameter of the points that holds texts; an empty list without it."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.kind != -1 or not parameter.dimensions:
            return []
        width = parameter.dimensions[0]
        parts = [parameter.data[k : k + width] for k in range(0, len(parameter.data), width or 1)]
        return [part.decode("utf-8", "replace").strip(" \0") for part in parts]

    def _value(self, name: str, default: float) -> float:
        """Return the first number of a parameter of the points."""
        parameter = self._parameters.get(name)
        if parameter is None or (len(parameter.data) < 4 and parameter.kind == 4):
            return default
        if parameter.kind == 4:
            return self._float(parameter.data[:4])
        if parameter.kind == 2 and len(parameter.data) >= 2:
            return float(struct.unpack_from(f"{self._order}H", parameter.data)[0])
        return default

    def _float(self, data: bytes) -> float:
        value = float(self._floats(data)[0])
        return value if math.isfinite(value) else 0.0

    def _floats(self, data: bytes) -> NDArray[np.float32]:
        if self._numbers == _DEC:  # its 16-bit words are swapped, and its exponents two larger
            words = np.frombuffer(data, "<u2").reshape(-1, 2)[:, ::-1]
            values = np.ascontiguousarray(words).view("<f4").ravel()
            return (values / 4.0).astype(np.float32)
        return np.frombuffer(data, f"{self._order}f4")

    def _cut(self, where: str) -> DatasetError:
        return DatasetError(f"{self._path}: is cut off {where}")


def _read_parameters(data: bytes, order: str) -> Mapping[str, _Parameter]:
    """Return the parameters of the group POINT, as far as the section is whole."""
    groups: dict[int, str] = {}
    found: dict[int, dict[str, _Parameter]] = {}
    offset = 0
    while offset + 4 <= len(data):
        length, number = struct.unpack_from("bb", data, offset)
        end = offset + 2 + abs(length)
        if not length or not number or end + 2 > len(data):
            break
        name = data[offset + 2 : end].decode("latin-1").upper()
        step = struct.unpack_from(f"{order}H", data, end)[0]
        if number < 0:
            groups[-number] = name
        elif (parameter := _parameter(data[end + 2 :])) is not None:
            found.setdefault(number, {}).setdefault(name, parameter)
        if step < 2:  # the last one
            break
        offset = end + step
    point = next((number for number, name in groups.items() if name == "POINT"), None)
    return found.get(point, {}) if point is not None else {}


def _parameter(data: bytes) -> _Parameter | None:
    """Return a parameter by what follows its name; None where it is cut off."""
    if len(data) < 2:
        return None
    kind, count = struct.unpack_from("bB", data)
    dimensions = tuple(data[2 : 2 + count])
    size = abs(kind) * math.prod(dimensions)
    begin = 2 + count
    if kind not in (-1, 1, 2, 4) or len(dimensions) < count or begin + size > len(data):
        return None
    return _Parameter(kind, dimensions, data[begin : begin + size])
