"""Writers of the files that motion-capture systems export, for tests; nothing is copied.

A scene is times [s] and bodies: positions (n, 3) [m], NaN where lost, and rotations (n, 4), as x,
y, z, w, or None for a marker; all in a right-handed world with z up.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # a y-up world from a z-up one


@dataclass
class Body:
    positions: np.ndarray
    rotations: np.ndarray | None = None


@dataclass
class Scene:
    times: np.ndarray
    bodies: dict[str, Body]
    rate: float = 100.0
    extra: dict = field(default_factory=dict)


def text(value, decimal=".", empty=""):
    return empty if not np.isfinite(value) else repr(float(value)).replace(".", decimal)


def write(path: Path, lines, encoding="utf-8", newline="\n") -> Path:
    path.write_bytes((newline.join(lines) + newline).encode(encoding))
    return path


def turned(body: Body, world) -> Body:
    """Return a body in another world, with its own axes turned alike."""
    positions = body.positions @ world.T
    if body.rotations is None:
        return Body(positions)
    turn = Rotation.from_matrix(world)
    return Body(positions, (turn * Rotation.from_quat(body.rotations) * turn.inv()).as_quat())


def motive(path, scene, version="1.23", unit="Millimeters", rotation="Quaternion", euler="XYZ",
           separator=",", decimal=".", parent=False):  # fmt: skip
    """Motive's CSV: y up, types, names, IDs, kinds and axes above the data."""
    scale = {"Millimeters": 1000.0, "Centimeters": 100.0, "Meters": 1.0}[unit]
    settings = [
        "Format Version", version, "Take Name", path.stem, "Take Notes", "", "Capture Frame Rate",
        f"{scene.rate:.6f}", "Export Frame Rate", f"{scene.rate:.6f}", "Total Frames in Take",
        str(len(scene.times)), "Rotation Type", rotation if rotation == "Quaternion" else euler,
        "Length Units", unit, "Coordinate Space", "Global",
    ]  # fmt: skip
    lead = ["", "Type"] if version >= "1.24" else ["", ""]
    types, names, ids, kinds, axes = (list(lead) for _ in range(5))
    names[1], ids[1] = ("Name", "ID") if version >= "1.24" else ("", "")
    kinds[1] = ""
    axes[:] = ["Frame", "Time (Seconds)"]
    columns = []
    for number, (name, body) in enumerate(scene.bodies.items()):
        body = turned(body, Y_UP)
        parts = []
        if body.rotations is not None:
            if rotation == "Quaternion":
                parts += [("Rotation", axis, body.rotations[:, k]) for k, axis in enumerate("XYZW")]
            else:
                angles = Rotation.from_quat(body.rotations).as_euler(euler, degrees=True)
                by_axis = {axis: angles[:, k] for k, axis in enumerate(euler)}
                parts += [("Rotation", axis, by_axis[axis]) for axis in "XYZ"]
        parts += [("Position", axis, scale * body.positions[:, k]) for k, axis in enumerate("XYZ")]
        if body.rotations is not None:
            parts.append(("Mean Marker Error", "", np.full(len(scene.times), 0.0002 * scale)))
        lost = ~np.isfinite(body.positions).all(axis=1)
        for kind, axis, values in parts:
            types.append("Rigid Body" if body.rotations is not None else "Marker")
            names.append(name)
            ids.append(f'"{number:04X}"')
            kinds.append(kind)
            axes.append(axis)
            columns.append(np.where(lost, np.nan, values))
    rows = [settings, [], types, names, ids]
    if parent:
        rows.append(["", "Parent", *[""] * len(columns)])
    rows += [kinds, axes]
    for k, t in enumerate(scene.times):
        rows.append([str(k), text(t, decimal), *(text(column[k], decimal) for column in columns)])
    return write(path, [separator.join(row) for row in rows], newline="\r\n")


def qtm_3d(path, scene, header=True, names=True, decimal=".", version=False, frames=True):
    """QTM's TSV of markers: millimetres, settings above the data."""
    lines = []
    if header:
        lines += ["FILE_VERSION\t2.0.0"] if version else []
        lines += [f"NO_OF_FRAMES\t{len(scene.times)}", "NO_OF_CAMERAS\t8",
                  f"NO_OF_MARKERS\t{len(scene.bodies)}", f"FREQUENCY\t{scene.rate:g}",
                  "NO_OF_ANALOG\t0", "ANALOG_FREQUENCY\t0", "DESCRIPTION\t--",
                  "TIME_STAMP\t2024-01-01, 10:00:00.000\t100.1", "DATA_INCLUDED\t3D",
                  "EVENT\tgo\t12\t0.12", "\t".join(["MARKER_NAMES", *scene.bodies])]  # fmt: skip
        lines += (
            ["\t".join(["TRAJECTORY_TYPES", *["Measured"] * len(scene.bodies)])] if version else []
        )
    lead = ["Frame", "Time"] if frames else []
    if names:
        lines.append(
            "\t".join([*lead, *(f"{name} {axis}" for name in scene.bodies for axis in "XYZ")])
        )
    for k, t in enumerate(scene.times):
        cells = [str(k + 1), text(t, decimal)] if frames else []
        for body in scene.bodies.values():
            cells += [text(1000 * v, decimal) for v in body.positions[k]]
        lines.append("\t".join(cells))
    return write(path, lines, newline="\r\n")


def qtm_6d(path, scene, prefixed=True, decimal=".", frames=True):
    """QTM's TSV of rigid bodies; zeros where one is lost."""
    lines = [f"NO_OF_FRAMES\t{len(scene.times)}", "NO_OF_CAMERAS\t8",
             f"NO_OF_BODIES\t{len(scene.bodies)}", f"FREQUENCY\t{scene.rate:g}", "DESCRIPTION\t--",
             "TIME_STAMP\t2024-01-01, 10:00:00\t100.1", "DATA_INCLUDED\t6D",
             "\t".join(["BODY_NAMES", *scene.bodies])]  # fmt: skip
    parts = ["X", "Y", "Z", "Roll", "Pitch", "Yaw", "Residual", *(f"Rot[{k}]" for k in range(9))]
    header = ["Frame", "Time"] if frames else []
    for name in scene.bodies:
        header += [f"{name} {part}" if prefixed or False else part for part in parts]
    lines.append("\t".join(header))
    for k, t in enumerate(scene.times):
        cells = [str(k + 1), text(t, decimal)] if frames else []
        for body in scene.bodies.values():
            if not np.isfinite(body.positions[k]).all():
                cells += ["0"] * 16
                continue
            turn = Rotation.from_quat([0, 0, 0, 1] if body.rotations is None else body.rotations[k])
            angles, matrix = turn.as_euler("XYZ", degrees=True), turn.as_matrix()
            numbers = [*(1000 * body.positions[k]), *angles, 0.3, *matrix.T.ravel()]
            cells += [text(v, decimal) for v in numbers]
        lines.append("\t".join(cells))
    return write(path, lines, newline="\r\n")


def vicon(
    path, scene, separator=",", decimal=".", section="Trajectories", subject="Anna", blank=False
):
    """Nexus' CSV: markers (Trajectories) or segments with axis times angle, in degrees."""
    turning = section != "Trajectories"
    parts = ["RX", "RY", "RZ", "TX", "TY", "TZ"] if turning else ["X", "Y", "Z"]
    units = ["deg"] * 3 + ["mm"] * 3 if turning else ["mm"] * 3
    names, axes, unit = ["", ""], ["Frame", "Sub Frame"], ["", ""]
    for name in scene.bodies:
        names += [f"{subject}:{name}", *[""] * (len(parts) - 1)]
        axes += parts
        unit += units
    rows = [[], []] if blank else []
    rows += [[section], [f"{scene.rate:g}"], names, axes, unit]
    for k, t in enumerate(scene.times):
        cells = [str(round(t * scene.rate) + 1), "0"]
        for body in scene.bodies.values():
            numbers = list(1000 * body.positions[k])
            if turning:
                numbers = [*np.degrees(Rotation.from_quat(body.rotations[k]).as_rotvec()), *numbers]
            lost = not np.isfinite(body.positions[k]).all()
            cells += ["" if lost else text(v, decimal) for v in numbers]
        rows.append(cells)
    return write(path, [separator.join(row) for row in rows])


def trc(path, scene, unit="mm", blank=True, end="\t"):
    """OpenSim's TRC."""
    scale = {"mm": 1000.0, "m": 1.0}[unit]
    n, frames = len(scene.bodies), len(scene.times)
    names, axes = "Frame#\tTime", "\t"
    for k, name in enumerate(scene.bodies, 1):
        names += f"\t{name}\t\t"
        axes += f"\tX{k}\tY{k}\tZ{k}"
    lines = [
        f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{scene.rate:.2f}\t{scene.rate:.2f}\t{frames}\t{n}\t{unit}\t{scene.rate:.2f}\t1\t{frames}",
        names, axes,
    ]  # fmt: skip
    lines += [""] if blank else []
    for k, t in enumerate(scene.times):
        cells = [str(k + 1), text(t)]
        for body in scene.bodies.values():
            cells += [text(scale * v) for v in body.positions[k]]
        lines.append("\t".join(cells) + end)
    return write(path, lines)


def motion_bids(folder, scene, stem="sub-01_task-reach_tracksys-omc"):
    """Motion-BIDS: samples without a header, channels and settings beside them."""
    folder.mkdir(parents=True, exist_ok=True)
    channels, columns = ["name\tcomponent\ttype\ttracked_point\tunits"], []
    for name, body in scene.bodies.items():
        for k, axis in enumerate("xyz"):
            channels.append(f"{name}_{axis}\t{axis}\tPOS\t{name}\tm")
            columns.append(body.positions[:, k])
        if body.rotations is not None:
            for k, axis in enumerate("xyzw"):
                channels.append(f"{name}_q{axis}\tquat_{axis}\tORNT\t{name}\tn/a")
                lost = ~np.isfinite(body.positions).all(axis=1)
                columns.append(np.where(lost, np.nan, body.rotations[:, k]))
    rows = ["\t".join(text(c[k], empty="n/a") for c in columns) for k in range(len(scene.times))]
    write(folder / f"{stem}_channels.tsv", channels)
    settings = {"SamplingFrequency": scene.rate, "TaskName": "reach", "TrackingSystemName": "omc"}
    (folder / f"{stem}_motion.json").write_text(json.dumps(settings))
    return write(folder / f"{stem}_motion.tsv", rows)


def c3d(path, scene, unit="mm"):
    """C3D of markers, Intel numbers, in 32-bit floats (c3d.org, "The C3D file format")."""
    scale = {"mm": 1000.0, "m": 1.0}[unit]
    labels, frames = list(scene.bodies), len(scene.times)

    def group(number, name):
        return struct.pack("<bb", len(name), -number) + name.encode() + struct.pack("<hB", 3, 0)

    def parameter(number, name, kind, dimensions, data):
        body = struct.pack("<bB", kind, len(dimensions)) + bytes(dimensions) + data + b"\0"
        head = struct.pack("<bb", len(name), number) + name.encode()
        return head + struct.pack("<h", 2 + len(body)) + body

    width = max(map(len, labels))
    parameters = group(1, "POINT")
    for name, kind, dimensions, data in (
        ("USED", 2, (), struct.pack("<h", len(labels))),
        ("FRAMES", 2, (), struct.pack("<h", frames)),
        ("SCALE", 4, (), struct.pack("<f", -1.0)),
        ("RATE", 4, (), struct.pack("<f", scene.rate)),
        ("DATA_START", 2, (), struct.pack("<h", 5)),
        ("UNITS", -1, (len(unit),), unit.encode()),
        ("LABELS", -1, (width, len(labels)), b"".join(n.ljust(width).encode() for n in labels)),
        ("DESCRIPTIONS", -1, (1, len(labels)), b" " * len(labels)),
    ):
        parameters += parameter(1, name, kind, dimensions, data)
    parameters += group(2, "ANALOG")
    for name, kind, dimensions, data in (
        ("USED", 2, (), struct.pack("<h", 0)), ("RATE", 4, (), struct.pack("<f", scene.rate)),
        ("GEN_SCALE", 4, (), struct.pack("<f", 1.0)),
    ):  # fmt: skip
        parameters += parameter(2, name, kind, dimensions, data)
    blocks = 3
    parameters = bytes([1, 0x50, blocks, 84]) + parameters + b"\0\0"
    assert len(parameters) <= 512 * blocks
    head = struct.pack(
        "<BBHHHHHfHHf", 2, 0x50, len(labels), 0, 1, frames, 0, -1.0, 5, 0, scene.rate
    )
    data = b""
    for k in range(frames):
        for body in scene.bodies.values():
            lost = not np.isfinite(body.positions[k]).all()
            numbers = [0, 0, 0, -1] if lost else [*(scale * body.positions[k]), 0]
            data += struct.pack("<4f", *numbers)
    path.write_bytes(head.ljust(512, b"\0") + parameters.ljust(512 * blocks, b"\0") + data)
    return path
