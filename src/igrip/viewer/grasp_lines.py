"""Grasp candidates as lines beside a mesh: the way of the palm, and thumb to fingers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.grasps.candidate import CLEARANCE, Candidate
from igrip.grasps.candidates import candidates_of
from igrip.objects.model import ObjectModel
from igrip.taxonomy import paper_grip

Array = NDArray[np.float64]

COLOURS = {"palmar": "#1a9850", "pinch": "#e08214"}  # by the paper's grip of the family
RING = 8  # drawn turns of a candidate that may be turned all round


def grasp_lines(model: ObjectModel, place: Array) -> list[dict[str, Any]]:
    """Return the candidates of a model as lines of the page.

    The object stands on its cylinder's axis, with the middle of that at ``place``, (3,) [m].
    """
    segments: dict[str, list[float]] = {grip: [] for grip in COLOURS}
    frame = model.mesh_from_object
    for candidate in candidates_of(model):
        for one in _turns(candidate):
            contacts, palm = one.contacts, one.palm(CLEARANCE)
            points = np.stack([palm, one.point, contacts[0], contacts[1]])
            local = (points - frame[:3, 3]) @ frame[:3, :3] + place
            segments[paper_grip(one.grip)] += local.round(5).ravel().tolist()
    return [{"colour": COLOURS[g], "points": points} for g, points in segments.items() if points]


def grasp_rows(model: ObjectModel) -> list[dict[str, Any]]:
    """Return the candidates of a model as plain data, in the frame of the mesh [m, rad]."""
    return [
        {
            "grip": c.grip, "part": c.part, "opening": round(c.opening, 4),
            "weight": round(c.weight, 3), "point": c.point.round(4).tolist(),
            "approach": c.approach.round(3).tolist(), "closing": c.closing.round(3).tolist(),
            "turns": [round(turn, 3) for turn in c.turns],
        }
        for c in candidates_of(model)
    ]  # fmt: skip


def _turns(candidate: Candidate) -> Iterator[Candidate]:
    low, high = candidate.turns
    count = max(1, round(RING * (high - low) / (2.0 * np.pi)))
    for k in range(count):
        yield candidate.turned(low + (k + 0.5) * (high - low) / count)
