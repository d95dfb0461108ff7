"""What the rows of an evaluation depend on, as one digest."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from pathlib import Path

from igrip.config import Config
from igrip.io.datasets.dataset import Dataset
from igrip.objects.catalog import YCB
from igrip.objects.mesh_files import MeshFile
from igrip.objects.mesh_folder import folder_meshes, ycb_meshes
from igrip.version import __version__

PACKAGE = Path(__file__).parents[2]


def fingerprint(dataset: Dataset, configs: Sequence[Config], objects: Sequence[str]) -> str:
    """Return a digest of the tables, the configurations, the meshes, the code and its weights.

    Recordings are not part of it (:meth:`Dataset.stamp`); ``objects`` are sources as
    :func:`igrip.load_objects` accepts them.
    """
    digest = hashlib.sha256(__version__.encode())
    for name in ("trials.tsv", "dataset.json"):
        digest.update((dataset.path / name).read_bytes())
    for config in configs:
        digest.update(config.model_dump_json().encode())
    for source in objects:
        digest.update(source.encode() + b"\n")
        for mesh in _meshes(source):
            digest.update(f"{mesh.name} {mesh.digest()}\n".encode())
    for path in sorted(path for ending in ("py", "json") for path in PACKAGE.rglob(f"*.{ending}")):
        digest.update(path.read_bytes())  # other code, other weights, other predictions
    return digest.hexdigest()[:16]


def _meshes(source: str) -> Iterable[MeshFile]:
    """Return the mesh files of a source of objects; a primitive has none."""
    if source == YCB:
        return ycb_meshes()
    return folder_meshes(Path(source)) if Path(source).is_dir() else ()
