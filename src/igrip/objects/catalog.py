"""Catalogues: models of objects by name, built once and kept on disk."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from igrip.compiled import cache_directory
from igrip.errors import MeshUnitError, ObjectsError, UnknownModelError, did_you_mean
from igrip.mesh.bvh import Bvh
from igrip.objects.array_cache import read_arrays, sources_digest, write_arrays
from igrip.objects.mesh_files import MeshFile, Primitive, parse_primitive
from igrip.objects.mesh_folder import folder_meshes, normal, ycb_meshes
from igrip.objects.model import ObjectModel, build_model

log = logging.getLogger(__name__)

YCB = "ycb"
PAPER_OBJECTS = (
    "003_cracker_box", "005_tomato_soup_can", "006_mustard_bottle", "021_bleach_cleanser",
)  # fmt: skip
YCB_VIDEO = (
    "002_master_chef_can", "003_cracker_box", "004_sugar_box", "005_tomato_soup_can",
    "006_mustard_bottle", "007_tuna_fish_can", "008_pudding_box", "009_gelatin_box",
    "010_potted_meat_can", "011_banana", "019_pitcher_base", "021_bleach_cleanser", "024_bowl",
    "025_mug", "035_power_drill", "036_wood_block", "037_scissors", "040_large_marker",
    "051_large_clamp", "052_extra_large_clamp", "061_foam_brick",
)  # fmt: skip
"""The objects of YCB-Video in the order of BOP, whose numbers begin at 1 (Hodan et al. 2018)."""
_CACHED_BY = (
    "objects/model.py", "objects/mesh_files.py", "objects/stray_bodies.py", "mesh/bvh.py",
    "mesh/inscribed_spheres.py", "mesh/ray.py", "mesh/nearest.py",
)  # fmt: skip


class Catalog(Mapping[str, ObjectModel]):
    """Models of objects by name or alias. A model is built or read on first access.

    Models of things that were first seen at run time are added by :meth:`put`.

    Parameters
    ----------
    *sources : str or Path
        What :func:`load_objects` accepts.
    """

    def __init__(self, *sources: str | Path) -> None:
        self._sources = sources
        self._meshes: dict[str, MeshFile | Primitive] = {}
        self._aliases: dict[str, str] = {}
        self._models: dict[str, ObjectModel] = {}
        self._put: dict[str, ObjectModel] = {}
        for source in sources:
            for mesh in _meshes_of(source):
                self._add(mesh)

    def _add(self, mesh: MeshFile | Primitive) -> None:
        for name in (mesh.name, *map(normal, mesh.options.alias)):
            if self._meshes.get(self._aliases.get(name, name), mesh) != mesh:
                raise ObjectsError(f"two objects are named {name!r}")
            self._aliases[name] = mesh.name
        self._meshes[mesh.name] = mesh

    def put(self, model: ObjectModel) -> None:
        """Add a model at run time, or replace one that was added so.

        May be called from another thread than those that read.

        Raises
        ------
        ObjectsError
            If a source of the catalogue has a model of this name.
        """
        if model.name in self._aliases and model.name not in self._put:
            raise ObjectsError(f"the catalogue has a model {model.name!r} already")
        self._put = {**self._put, model.name: model}
        self._models[model.name] = model
        self._aliases[model.name] = model.name

    @property
    def put_models(self) -> Mapping[str, ObjectModel]:
        """The models that were added at run time, by name."""
        return self._put

    def is_described(self, name: str) -> bool:
        """Return whether a table or the user names this model, so that it is not left out."""
        mesh = self._meshes[name]
        return not isinstance(mesh, MeshFile) or mesh.described

    def leave_out(self, name: str) -> None:
        """Remove a model whose file cannot be used."""
        del self._meshes[name]
        self._aliases = {alias: own for alias, own in self._aliases.items() if own != name}

    def __getitem__(self, name: str) -> ObjectModel:
        """Return a model by name or alias.

        Raises
        ------
        UnknownModelError
            If the catalogue has none of this name.
        ObjectsError
            If its file cannot be used.
        """
        try:
            own = self._aliases[name if name in self._aliases else normal(name)]
        except (KeyError, TypeError):
            near = did_you_mean(str(name)[:80], self._aliases)
            raise UnknownModelError(f"the catalogue has no model {name!r:.80}{near}") from None
        if own not in self._models:
            self._models[own] = _load(self._meshes[own])
        return self._models[own]

    def __iter__(self) -> Iterator[str]:
        return iter((*self._meshes, *self._put))

    def __len__(self) -> int:
        return len(self._meshes) + len(self._put)

    def __contains__(self, name: object) -> bool:
        return name in self._aliases or (isinstance(name, str) and normal(name) in self._aliases)

    def __reduce__(self) -> tuple[Any, tuple[str | Path, ...]]:
        return Catalog, self._sources

    def __repr__(self) -> str:
        return f"Catalog of {len(self)} models from {', '.join(map(str, self._sources))}"


def load_objects(*sources: str | Path) -> Catalog:
    """Open a catalogue of objects.

    Parameters
    ----------
    *sources : str or Path
        Any number of: ``"ycb"``, the YCB set; a folder of meshes, with an optional
        ``objects.toml`` (:class:`igrip.objects.mesh_files.MeshOptions`); a primitive such as
        ``"box:0.07x0.16x0.21"`` or ``"cylinder:0.033x0.10"`` (radius, height) in metres.

    Raises
    ------
    ObjectsError
        If a source does not exist, holds nothing that can be read, or two objects share a name. A
        file of a folder that cannot be read and that no table names is left out, with a warning.
    MeshUnitError
        If a mesh of a folder is implausible in metres; the message explains the remedy.

    Examples
    --------
    >>> len(load_objects("ycb"))
    78
    """
    if not sources:
        raise ObjectsError("name at least one source of objects, for example 'ycb'")
    catalog = Catalog(*sources)
    for source in sources:
        if _is_folder(source):  # a wrong unit or file raises here, not in mid-reach
            _load_folder(catalog, source)
    return catalog


def _load_folder(catalog: Catalog, source: str | Path) -> None:
    """Load all models of a folder, and leave out those whose files are damaged."""
    names = [mesh.name for mesh in _meshes_of(source) if mesh.name in catalog]
    problems: dict[str, ObjectsError] = {}
    for name in names:
        try:
            catalog[name]
        except MeshUnitError:
            raise
        except ObjectsError as error:
            if catalog.is_described(name):
                raise
            problems[name] = error
    if names and len(problems) == len(names):
        raise next(iter(problems.values()))
    for name, problem in problems.items():
        log.warning("left out: %s", problem)
        catalog.leave_out(name)


def _is_folder(source: str | Path) -> bool:
    return source != YCB and parse_primitive(str(source)) is None


def _meshes_of(source: str | Path) -> list[MeshFile] | list[Primitive]:
    if source == YCB:
        return ycb_meshes()
    primitive = parse_primitive(str(source))
    if primitive is not None:
        return [primitive]
    folder = Path(source)
    if not folder.is_dir():
        raise ObjectsError(
            f"{source}: expected 'ycb', a folder of meshes, 'box:DXxDYxDZ' or "
            "'cylinder:RADIUSxHEIGHT'"
        )
    return folder_meshes(folder)


def _load(mesh: MeshFile | Primitive) -> ObjectModel:
    """Read a model from the cache, or build it and put it there."""
    try:
        digest = mesh.digest()
    except OSError as error:
        raise ObjectsError(f"{mesh.name}: cannot be read: {error}") from error
    path = cache_directory() / "models" / f"{sources_digest(_CACHED_BY)[:8]}-{digest[:32]}.npz"
    cached = _read_cache(path, mesh)
    if cached is not None:
        model, remarks = cached
        _warn(remarks)
        return model
    axis = mesh.options.axis
    if axis is not None and not np.linalg.norm(axis) > 1e-9:
        raise ObjectsError(f"{mesh.name}: its axis has no direction")
    model = build_model(
        mesh.name, mesh.read(), mesh.options.symmetry, None if axis is None else np.array(axis)
    )
    model = replace(model, grasps=mesh.options.grasps)
    remarks = mesh.remarks if isinstance(mesh, MeshFile) else []
    _write_cache(path, model, remarks)
    _warn(remarks)
    return model


def _warn(remarks: Sequence[str]) -> None:
    for remark in remarks:
        log.warning(remark)


_TREES = ("bvh", "vertex_tree")
_SCALARS = ("length", "radius")
_ARRAYS = ("vertices", "faces", "centre", "mesh_from_object", "sphere", "inscribed_spheres")


def _read_cache(path: Path, mesh: MeshFile | Primitive) -> tuple[ObjectModel, list[str]] | None:
    """Return a model and what was odd about its file; None where the cache has no whole one."""
    stored = read_arrays(path)
    if stored is None:
        return None
    try:
        fields: dict[str, Any] = {name: stored[name] for name in _ARRAYS}
        fields.update({name: float(stored[name]) for name in _SCALARS})
        for tree in _TREES:
            fields[tree] = Bvh(*(stored[f"{tree}_{name}"] for name in Bvh._fields))
        remarks = [str(remark) for remark in stored["remarks"]]
    except (KeyError, TypeError):
        return None  # it is built again
    options = mesh.options
    model = ObjectModel(
        name=mesh.name, symmetry=options.symmetry, grasps=options.grasps, **fields
    )  # fmt: skip
    return model, remarks


def _write_cache(path: Path, model: ObjectModel, remarks: Sequence[str]) -> None:
    arrays: dict[str, Any] = {name: getattr(model, name) for name in (*_ARRAYS, *_SCALARS)}
    arrays["remarks"] = np.array(remarks, dtype=str)
    for tree in _TREES:
        parts = getattr(model, tree)._asdict()
        arrays.update({f"{tree}_{name}": array for name, array in parts.items()})
    write_arrays(path, arrays)
