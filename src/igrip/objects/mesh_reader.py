"""Reading a file of a mesh, with bounds on what it may ask for before anything is allocated."""

from __future__ import annotations

import codecs
import io
import json
import math
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

MAX_BYTES = 1 << 30  # of a file
MAX_FACES = 5_000_000  # of all bodies together, each as often as it is placed
MAX_RATIO = 100  # of what an archive holds to its size
MAX_SHARED = 2  # times that the bytes of a glTF file may be referred to
TEXT = (".obj", ".off", ".ply", ".stl", ".gltf", ".dae")  # formats that may be text
WITH_MATERIALS = (".obj", ".ply", ".glb", ".gltf")  # formats whose pictures are not needed
UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}  # of glTF's component types
_PARTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def read_mesh_file(path: Path) -> Any:
    """Return what trimesh reads from a file; pictures of its surface are left out.

    Raises
    ------
    ValueError or other
        If it cannot be read, or asks for more memory than its size allows for.
    """
    ending = path.suffix.lower()
    size = path.stat().st_size
    if size > MAX_BYTES:
        raise ValueError(f"has {size / 1e9:.1f} GB, more than {MAX_BYTES / 1e9:.1f}")
    data = path.read_bytes()
    if ending in TEXT:
        data = _as_utf8(data, ending)
    if ending in (".glb", ".gltf"):
        _check_gltf(_gltf_header(data, ending), len(data) + _bytes_beside(path, ending))
    elif ending == ".3mf":
        _check_archive(data)
    options = {"skip_materials": True} if ending in WITH_MATERIALS else {}
    loaded = trimesh.load(
        io.BytesIO(data),  # a read from it allocates no more than there is
        file_type=ending.lstrip("."), resolver=trimesh.resolvers.FilePathResolver(str(path)),
        **options,
    )  # fmt: skip
    _check_faces(loaded)
    return loaded


def read_text(path: Path) -> str:
    """Return a small text file in UTF-8 or UTF-16, with or without a byte order mark.

    Raises
    ------
    OSError, UnicodeDecodeError
        If it cannot be read, or is no such text.
    """
    return _as_utf8(path.read_bytes(), path.suffix).decode()


def _as_utf8(data: bytes, ending: str) -> bytes:
    """Return a text without a byte order mark, in UTF-8; other bytes as they are."""
    if data.startswith(codecs.BOM_UTF8):
        return data[len(codecs.BOM_UTF8) :]
    # a binary STL may begin with any bytes
    if data.startswith(UTF_16) and ending not in (".stl", ".dae"):
        return data.decode("utf-16").encode()
    return data


def _gltf_header(data: bytes, ending: str) -> Mapping[str, Any]:
    """Return the JSON of a glTF file; empty where there is none, which its reader will report."""
    if ending == ".glb":
        length = int.from_bytes(data[12:16], "little")
        data = data[20 : 20 + length]
    try:
        header = json.loads(data)
    except (ValueError, RecursionError):
        return {}
    return header if isinstance(header, dict) else {}


def _bytes_beside(path: Path, ending: str) -> int:
    if ending != ".gltf":
        return 0
    return sum(file.stat().st_size for file in path.parent.glob("*.bin"))


def _check_gltf(header: Mapping[str, Any], available: int) -> None:
    """Compare what the accessors of a glTF file take with the bytes that there are."""
    required = header.get("extensionsRequired", ())
    for name in required if isinstance(required, list) else ():
        if "compression" in str(name):
            raise ValueError(f"is compressed by {name}: export it without compression")
    accessors = header.get("accessors", ())
    total = 0.0
    for one in accessors if isinstance(accessors, list) else ():
        if not isinstance(one, dict) or not isinstance(one.get("count", 0), (int, float)):
            raise ValueError("has an accessor without a number as its count")
        each = _BYTES.get(one.get("componentType", 0), 4) * _PARTS.get(str(one.get("type")), 16)
        total += max(0.0, float(one.get("count", 0))) * each
    if not total <= MAX_SHARED * available or not math.isfinite(total):
        raise ValueError(f"refers to {total:.3g} bytes, and holds {available}")


def _check_archive(data: bytes) -> None:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        size = sum(entry.file_size for entry in archive.infolist())
    if size > MAX_RATIO * len(data) or size > MAX_BYTES:
        raise ValueError(f"becomes {size} bytes when decompressed, from {len(data)}")


def _check_faces(loaded: Any) -> None:
    """Check the corners, and count the faces of bodies that are placed many times."""
    scene = isinstance(loaded, trimesh.Scene)
    for body in loaded.geometry.values() if scene else (loaded,):
        corners = np.asarray(getattr(body, "faces", ()))
        if corners.size and not 0 <= corners.min() <= corners.max() < len(body.vertices):
            raise ValueError(f"a face has corner {corners.max()} of {len(body.vertices)}")
    if not scene:
        return
    faces = {name: len(getattr(body, "faces", ())) for name, body in loaded.geometry.items()}
    placed = (loaded.graph[node][1] for node in loaded.graph.nodes_geometry)
    count = sum(faces.get(name, 0) for name in placed)
    if count > MAX_FACES:
        raise ValueError(f"has {count} faces, more than {MAX_FACES}: simplify it first")
