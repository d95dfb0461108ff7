"""Meshes of the BOP benchmark: ``models/obj_000001.ply`` and ``models_info.json``, in millimetres.

``models_info.json`` holds symmetries by object: continuous ones have an axis, discrete ones are 4×4
matrices (bop.felk.cvut.cz, "BOP dataset format").
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from igrip.errors import ObjectsError
from igrip.objects.mesh_reader import read_text

INFO = "models_info.json"
HALF_TURN = 0.02  # largest difference of a matrix from that of a half turn


def bop_options(path: Path) -> dict[str, Any]:
    """Return the options of a mesh of BOP by the file beside it; nothing for any other mesh.

    Raises
    ------
    ObjectsError
        If that file is damaged.
    """
    match = re.fullmatch(r"obj_(\d+)", path.stem.lower())
    info = path.parent / INFO
    if match is None or not info.is_file():
        return {}
    entry = _read(info).get(str(int(match[1])), {})
    options: dict[str, Any] = {"unit": "mm"}
    continuous = entry.get("symmetries_continuous") or []
    if continuous:
        try:
            axis = tuple(float(value) for value in continuous[0]["axis"])
        except (KeyError, TypeError, ValueError):
            raise ObjectsError(
                f"{info}: object {match[1]}: symmetries_continuous has no axis"
            ) from None
        return options | {"symmetry": "cylinder", "axis": axis}
    if len(_half_turns(entry.get("symmetries_discrete") or [])) >= 3:
        options["symmetry"] = "box"
    return options


def _half_turns(matrices: Sequence[Any]) -> list[int]:
    """Return the axes (0, 1, 2) about which half turns are among the symmetries."""
    axes = []
    for numbers in matrices:
        matrix = np.asarray(numbers, dtype=np.float64).ravel()
        if matrix.size != 16:
            continue
        rotation = matrix.reshape(4, 4)[:3, :3]
        for axis in range(3):
            half = -np.eye(3)
            half[axis, axis] = 1.0
            if np.abs(rotation - half).max() < HALF_TURN:
                axes.append(axis)
    return sorted(set(axes))


@lru_cache(maxsize=8)
def _read(path: Path) -> Mapping[str, Any]:
    try:
        info = json.loads(read_text(path))
    except (OSError, ValueError) as error:
        raise ObjectsError(f"{path}: {error}") from error
    if not isinstance(info, dict) or not all(isinstance(entry, dict) for entry in info.values()):
        raise ObjectsError(f"{path}: must be a table of objects")
    return info
