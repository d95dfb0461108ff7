"""The time courses of one hand (the paper's Figure 6), for the report and for the page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.intention import Intention

Array = NDArray[np.float64]
GRIPS = ("palmar", "pinch")


class TimeCourses(NamedTuple):
    """What an estimator answered for one hand over time; NaN where there is no value.

    Attributes
    ----------
    times, speed : (n,)
        Of the answers [s], and of the hand [m/s].
    objects : tuple of str
        The objects, in the order of the rows.
    scores : dict of str to (objects, n)
        Of each cue, and ``global``.
    probability : (objects + 1, n)
        Of each object and, last, of none.
    target : (objects, n)
        Whether an object was the target.
    grip : (2, n)
        Whether the grip was each of :data:`GRIPS`.
    """

    times: Array
    speed: Array
    objects: tuple[str, ...]
    scores: dict[str, Array]
    probability: Array
    target: NDArray[np.bool_]
    grip: NDArray[np.bool_]


def time_courses(
    intentions: Sequence[Intention], speeds: Sequence[float], max_objects: int | None = None
) -> TimeCourses:
    """Gather the time courses of one hand.

    Parameters
    ----------
    intentions : sequence of Intention
        Of one hand, in order of time.
    speeds : sequence of float
        Of the hand at each [m/s].
    max_objects : int, optional
        Only so many objects: past targets first, then those that are likeliest now.
    """
    objects = _choose_objects(intentions, max_objects)
    names = dict.fromkeys(name for i in intentions for row in i.scores.values() for name in row)

    def rows(table: list[list[Any]], kind: type) -> Any:
        return np.array(table, dtype=kind).reshape(len(table), len(intentions))  # None: NaN

    return TimeCourses(
        times=np.array([i.t for i in intentions], dtype=np.float64),
        speed=np.array(speeds, dtype=np.float64),
        objects=objects,
        scores={
            name: rows(
                [[i.scores.get(o, {}).get(name) for i in intentions] for o in objects], float
            )
            for name in names
        },
        probability=rows(
            [[(i.probability or {}).get(o) for i in intentions] for o in (*objects, "none")], float
        ),
        target=rows([[i.target == o for i in intentions] for o in objects], bool),
        grip=rows([[i.grip == grip for i in intentions] for grip in GRIPS], bool),
    )


def _choose_objects(intentions: Sequence[Intention], max_objects: int | None) -> tuple[str, ...]:
    known = {id: None for intention in intentions for id in intention.scores}
    if max_objects is None or len(known) <= max_objects:
        return tuple(sorted(known))
    targets = dict.fromkeys(i.target for i in reversed(intentions) if i.target)
    newest = intentions[-1].scores
    likely = sorted(known, key=lambda id: (-newest.get(id, {}).get("global", -np.inf), id))
    return tuple(sorted(list(dict.fromkeys([*targets, *likely]))[:max_objects]))
