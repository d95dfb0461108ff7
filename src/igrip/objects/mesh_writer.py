"""Models written as a folder of meshes, which :func:`igrip.load_objects` reads."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import trimesh

from igrip.objects.mesh_files import TABLE
from igrip.objects.model import ObjectModel


def models_beside(recording: str | Path) -> Path:
    """Return the folder of the models that a recording needs: ``NAME.objects`` beside it."""
    return Path(recording).with_suffix(".objects")


def write_models(folder: str | Path, models: Mapping[str, ObjectModel]) -> None:
    """Write models as PLY files in metres, with their axes in ``objects.toml``; none: nothing.

    Axis and symmetry are written, so that the models are read as they are.
    """
    if not models:
        return
    into = Path(folder)
    into.mkdir(parents=True, exist_ok=True)
    lines = []
    for number, (name, model) in enumerate(models.items(), 1):
        file = f"{number:03d}.ply"
        mesh = trimesh.Trimesh(model.vertices, model.faces, process=False)
        (into / file).write_bytes(trimesh.exchange.ply.export_ply(mesh))
        axis = ", ".join(f"{value:.9f}" for value in model.axis)
        lines.append(
            f'[{json.dumps(name)}]\nfile = {json.dumps(file)}\nunit = "m"\naxis = [{axis}]\n'
            f"symmetry = {json.dumps(model.symmetry)}\n"
        )
    (into / TABLE).write_text("\n".join(lines), encoding="utf-8")
