"""The grasp candidates of a model: declared, or found in its mesh once and kept on disk."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from igrip.compiled import cache_directory
from igrip.grasps.build import build_candidates
from igrip.grasps.candidate import Candidate
from igrip.objects.array_cache import read_arrays, sources_digest, write_arrays
from igrip.objects.declared_grasp import DeclaredGrasp
from igrip.objects.model import ObjectModel

_CACHED_BY = (
    "taxonomy.py", "grasps/build.py", "grasps/candidate.py", "grasps/classify.py",
    "grasps/clusters.py", "grasps/hand_fit.py", "grasps/opposition.py", "grasps/parts.py",
    "grasps/surface.py", "grasps/turns.py", "grasps/verify.py",
)  # fmt: skip
_known: WeakKeyDictionary[ObjectModel, tuple[Candidate, ...]] = WeakKeyDictionary()


def candidates_of(model: ObjectModel) -> tuple[Candidate, ...]:
    """Return how an object can be grasped, the likeliest way first; declared ways stand alone.

    The first call for a mesh takes about a second; its result is kept on disk.
    """
    found = _known.get(model)
    if found is None:
        found = _known[model] = _declared(model.grasps) if model.grasps else _computed(model)
    return found


def _declared(grasps: Sequence[DeclaredGrasp]) -> tuple[Candidate, ...]:
    total = sum(grasp.weight for grasp in grasps)
    every = (_candidate(grasp, grasp.weight / total) for grasp in grasps)
    return tuple(sorted(every, key=lambda candidate: -candidate.weight))


def _candidate(grasp: DeclaredGrasp, weight: float) -> Candidate:
    approach = np.array(grasp.approach) / np.linalg.norm(grasp.approach)
    closing = np.array(grasp.closing) - (np.array(grasp.closing) @ approach) * approach
    axis = np.array(grasp.axis or (0.0, 0.0, 1.0))
    return Candidate(
        grasp.grip, grasp.part, np.array(grasp.point), approach,
        closing / np.linalg.norm(closing), grasp.opening, grasp.depth, weight,
        np.array(grasp.pivot or grasp.point), axis / np.linalg.norm(axis),
        (-grasp.turn, grasp.turn),
    )  # fmt: skip


def _computed(model: ObjectModel) -> tuple[Candidate, ...]:
    path = _path(model)
    stored = read_arrays(path)
    if stored is not None and set(Candidate._fields) == set(stored):
        columns = [stored[name] for name in Candidate._fields]
        return tuple(_restored(row) for row in zip(*columns, strict=True))
    found = tuple(build_candidates(model))
    write_arrays(path, {
        name: np.array([getattr(candidate, name) for candidate in found])
        for name in Candidate._fields
    })  # fmt: skip
    return found


def _restored(row: Sequence[Any]) -> Candidate:
    one = Candidate(*row)
    return one._replace(
        grip=str(one.grip), part=str(one.part), opening=float(one.opening),
        depth=float(one.depth), weight=float(one.weight),
        turns=(float(one.turns[0]), float(one.turns[1])),
    )  # fmt: skip


def _path(model: ObjectModel) -> Path:
    digest = hashlib.sha256(model.symmetry.encode())
    for array in (model.vertices, model.faces, model.mesh_from_object):
        digest.update(np.ascontiguousarray(array).tobytes())
    name = f"{sources_digest(_CACHED_BY)[:8]}-{digest.hexdigest()[:32]}.npz"
    return cache_directory() / "grasps" / name
