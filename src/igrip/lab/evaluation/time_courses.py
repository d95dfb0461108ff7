"""The time courses of one hand (the paper's Figure 6), for the report and for the page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.intention import Intention

Array = NDArray[np.float64]
GRIPS = ("palmar", "pinch")
SPEED, TARGET, GRIP = "speed [m/s]", "target", "grip"


class TimeCourses(NamedTuple):
    """What was predicted for one hand over time.

    Each panel, (lines, n) with NaN for nothing, has one line for the speed, one for each object
    for a score and for the target (its number, from 1), and one for each grip (1 or 2).
    """

    times: Array  # of the predictions, (n,) [s]
    objects: tuple[str, ...]  # which have a line each
    panels: dict[str, Array]
    none: Array  # probability of no target, (n,)


def time_courses(
    intentions: Sequence[Intention], speeds: Sequence[float], max_objects: int | None = None
) -> TimeCourses:
    """Gather the time courses of one hand from its intentions and its speed at each [m/s].

    With more than ``max_objects``, past targets come first, then those that are likeliest now.
    """
    objects = _choose_objects(intentions, max_objects)
    n = len(intentions)
    names = dict.fromkeys(name for i in intentions for row in i.scores.values() for name in row)
    panels = {SPEED: np.array(speeds, dtype=np.float64).reshape(1, n)}
    panels |= {name: np.full((len(objects), n), np.nan) for name in names}
    panels |= {TARGET: np.full((len(objects), n), np.nan), GRIP: np.full((len(GRIPS), n), np.nan)}
    for k, intention in enumerate(intentions):
        for o, id in enumerate(objects):
            for name, value in intention.scores.get(id, {}).items():
                panels[name][o, k] = value
            if intention.target == id:
                panels[TARGET][o, k] = o + 1
        if intention.grip in GRIPS:
            g = GRIPS.index(intention.grip)
            panels[GRIP][g, k] = g + 1
    none = [(i.probability or {}).get("none", np.nan) for i in intentions]
    return TimeCourses(np.array([i.t for i in intentions]), objects, panels, np.array(none))


def _choose_objects(intentions: Sequence[Intention], max_objects: int | None) -> tuple[str, ...]:
    known = {id: None for intention in intentions for id in intention.scores}
    if max_objects is None or len(known) <= max_objects:
        return tuple(sorted(known))
    targets = dict.fromkeys(i.target for i in reversed(intentions) if i.target)
    newest = intentions[-1].scores
    likely = sorted(known, key=lambda id: (-newest.get(id, {}).get("global", -np.inf), id))
    return tuple(sorted(list(dict.fromkeys([*targets, *likely]))[:max_objects]))
