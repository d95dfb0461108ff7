"""Meshes: files with their options, or primitives written as text."""

from __future__ import annotations

import hashlib
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import trimesh

from igrip.errors import MeshUnitError, ObjectsError
from igrip.objects.declared_grasp import DeclaredGrasp
from igrip.objects.mesh_reader import read_mesh_file
from igrip.objects.stray_bodies import without_ground_plane
from igrip.settings import Settings

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
MIN_EXTENT, MAX_EXTENT = 0.002, 2.0  # m; beyond any object that a hand can grasp
LARGE = 1.0  # m; a mesh without a declared unit that is longer is remarked
USUAL = 0.15  # m; which of several units is the likeliest
TABLE = "objects.toml"
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
    grasps : list of DeclaredGrasp
        How it is grasped, in place of what its mesh allows (:mod:`igrip.grasps`).
    """

    file: str | None = None
    unit: Literal["m", "cm", "mm", "in"] | None = None
    frame: Literal["mesh", "box"] = "mesh"
    axis: tuple[float, float, float] | None = None
    symmetry: Literal["none", "cylinder", "box"] = "none"
    alias: tuple[str, ...] = ()
    grasps: tuple[DeclaredGrasp, ...] = ()


@dataclass(frozen=True)
class MeshFile:
    """A mesh in a file, with its options.

    Attributes
    ----------
    name : str
        In the catalogue.
    path : Path
        The file.
    options : MeshOptions
        Its options.
    described : bool
        Whether a table names it, so that it must not be left out.
    remarks : list of str
        What was odd when it was read.
    """

    name: str
    path: Path
    options: MeshOptions
    described: bool = True
    remarks: list[str] = field(default_factory=list, compare=False)

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
            loaded = read_mesh_file(self.path)
        except Exception as error:  # each format's reader has its own kinds of error
            raise ObjectsError(f"{self.path}: cannot be read as a mesh: {error}") from error
        units = loaded.units
        mesh, remark = without_ground_plane(loaded)
        if remark is not None:
            self.remarks.append(f"{self.path}: {remark}")
        if mesh is None:
            raise ObjectsError(f"{self.path}: {_no_mesh(loaded)}")
        if mesh.vertices.shape[1:] != (3,):
            raise ObjectsError(f"{self.path}: cannot be read as a mesh: its points are not triples")
        if not np.isfinite(mesh.vertices).all():
            raise ObjectsError(f"{self.path}: has coordinates that are not finite")
        raw = float(np.max(mesh.extents))
        if units is not None:
            mesh.units = units
        if self.options.unit is not None:
            mesh.apply_scale(METRES[self.options.unit])
        elif mesh.units is not None:
            mesh.convert_units("meters")
        extent = float(np.max(mesh.extents))
        if not MIN_EXTENT <= extent <= MAX_EXTENT:
            raise MeshUnitError(self._unit_problem(extent, raw))
        if self.options.unit is None and units is None and extent > LARGE:
            self.remarks.append(
                f"{self.path}: is {extent:.3g} m long if its unit is 'm'; {_offers(raw, 'm')}"
            )
        if self.options.frame == "box":
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
        return mesh

    def _unit_problem(self, extent: float, raw: float) -> str:
        unit = self.options.unit or "m"
        fitting = _fitting_units(raw, unit)
        guess = fitting[0] if fitting else "m"
        offers = f"; {_offers(raw, unit)}" if fitting else ""
        return (
            f"{self.path}: is {extent:.4g} m long if its unit is {unit!r}, too large or too "
            f"small for a hand to grasp{offers}. Declare its unit in {self.path.parent / TABLE} "
            f'(for all meshes: [defaults]):\n[{self.name}]\nunit = "{guess}"'
        )


def _fitting_units(raw: float, declared: str) -> list[str]:
    """Return the units that make an object of this length graspable, the likeliest first."""
    sizes = {unit: raw * METRES[unit] for unit in METRES if unit != declared}
    fitting = [unit for unit, size in sizes.items() if MIN_EXTENT <= size <= MAX_EXTENT]
    # inches are rare
    return sorted(fitting, key=lambda unit: (unit == "in", abs(math.log(sizes[unit] / USUAL))))


def _offers(raw: float, declared: str) -> str:
    units = _fitting_units(raw, declared)
    return "it would be " + ", ".join(f"{raw * METRES[unit]:.3g} m in {unit!r}" for unit in units)


def _no_mesh(loaded: Any) -> str:
    """Return why a file that was read holds no mesh."""
    points = getattr(loaded, "vertices", ())
    if len(points):
        return (
            f"holds {len(points)} points and no mesh with faces: make a surface of them first, for "
            "example with the Poisson reconstruction of MeshLab"
        )
    return "holds no mesh with faces"


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
    """Read a primitive such as ``box:0.07x0.16x0.21``; None if the text names no primitive.

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
