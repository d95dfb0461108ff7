"""A scanned thing as an entry of a folder of meshes: mesh, picture, options and how it was made."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.errors import IgripError
from igrip.io.whole_files import write_whole
from igrip.objects.mesh_files import TABLE
from igrip.objects.mesh_folder import ENDINGS, ycb_meshes
from igrip.objects.mesh_reader import read_text
from igrip.perception.opencv import load_opencv

NAME = re.compile(r"[^\W_][\w.-]*")

BARE = re.compile(r"[A-Za-z0-9_-]+")  # what TOML takes for a key without quotes


class Scan(NamedTuple):
    """What a scan made."""

    mesh: trimesh.Trimesh  # in metres, z up, origin on the table under its middle
    picture: NDArray[np.uint8]  # (h, w, 3), cropped to the thing
    round_thing: bool  # whether it looks the same from all sides
    about: dict[str, Any]  # how it was made, for people


def check_name(folder: Path, name: str, replace: bool) -> None:
    """Refuse a name that a catalogue could not use, or that the folder has already.

    Raises
    ------
    IgripError
        The message says what to do.
    """
    if not NAME.fullmatch(name) or name.lower() in ("none", "defaults"):
        raise IgripError(f"{name!r} cannot be a name: use letters, digits, _ . and -, as in my_mug")
    if any(mesh.name == name for mesh in ycb_meshes()):
        raise IgripError(f"{name} is a model of the YCB set: choose another name")
    taken = [folder / f"{name}.{ending}" for ending in ENDINGS]
    there = next((path for path in taken if path.exists()), None)
    if there is not None and not (replace and there.suffix == ".ply"):
        way = ", or replace it with --replace" if there.suffix == ".ply" else ""
        raise IgripError(f"{there} exists: choose another name{way}")
    if name in _tables(folder / TABLE) and not replace:
        raise IgripError(
            f"{folder / TABLE} has a table [{name}]: choose another name, or replace it with "
            "--replace"
        )


def write_entry(folder: Path, name: str, scan: Scan) -> Path:
    """Write a scan into a folder, which :func:`igrip.load_objects` reads; return its mesh file.

    Other entries of the folder stay as they are; one of the same name is replaced.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.ply"
    cv2 = load_opencv("the picture of a scan")
    path.write_bytes(trimesh.exchange.ply.export_ply(scan.mesh))
    written, data = cv2.imencode(".png", np.ascontiguousarray(scan.picture[..., ::-1]))
    if written:
        (folder / f"{name}.png").write_bytes(data.tobytes())
    write_whole(folder / f"{name}.json", json.dumps(scan.about, indent=2) + "\n")
    key = name if BARE.fullmatch(name) else json.dumps(name)
    table = f'[{key}]\nfile = {json.dumps(path.name)}\nunit = "m"\n'
    if scan.round_thing:
        table += 'symmetry = "cylinder"\naxis = [0.0, 0.0, 1.0]\n'
    others = _without(folder / TABLE, name)
    write_whole(folder / TABLE, f"{others}\n{table}" if others else table)
    return path


def _tables(path: Path) -> dict[str, Any]:
    if not path.exists():
        return {}
    try:
        return tomllib.loads(read_text(path))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise IgripError(f"{path}: {error}; correct it, or name another folder") from error


def _without(path: Path, name: str) -> str:
    """Return the text of a table of options without one entry."""
    if not path.exists():
        return ""
    kept, inside = [], False
    for line in read_text(path).splitlines():
        if line.lstrip().startswith("["):
            header = line.split("#")[0].strip().strip("[]").strip().strip("\"'")
            inside = header == name or header.startswith((f"{name}.", f'{name}".'))
        if not inside:
            kept.append(line)
    return "\n".join(kept).rstrip() + "\n"
