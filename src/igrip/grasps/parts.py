"""What the part of an object that a candidate takes is called."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from igrip.grasps.candidate import Candidate
from igrip.grasps.classify import ELONGATED, END, SHEET
from igrip.objects.model import ObjectModel
from igrip.taxonomy import GRIP_TYPES

NARROW = 0.75  # of the widest grasp of the sides; a neck is narrower
OFF_CENTRE = 0.4  # of the half-length


def name_parts(candidates: Sequence[Candidate], model: ObjectModel) -> list[Candidate]:
    """Return the candidates with their parts named.

    ``handle``: what a hook takes; ``rim``: a sheet; ``end`` (a lid, for a bottle): an end of a long
    object; ``neck``: a narrow part of its sides, off its middle; ``knob``: what three fingers take;
    ``body``: the rest.
    """
    powers = [c.opening for c in candidates if GRIP_TYPES[c.grip].family == "power"]
    widest = max(powers, default=0.0)
    return [c._replace(part=_part(c, widest, model)) for c in candidates]


def _part(candidate: Candidate, widest: float, model: ObjectModel) -> str:
    height = abs(float((candidate.point - model.origin) @ model.axis))
    along = abs(float(candidate.approach @ model.axis))
    is_long = model.length > ELONGATED * 2.0 * model.radius
    kinds = {
        "handle": candidate.grip == "hook",
        "rim": candidate.opening <= SHEET,
        "end": is_long and along > END,
        "neck": is_long and candidate.opening < NARROW * widest
        and height > OFF_CENTRE * 0.5 * model.length,
        "knob": candidate.grip == "tripod",
    }  # fmt: skip
    return next((name for name, holds in kinds.items() if bool(np.all(holds))), "body")
