"""From reliable to reactive: the configurations among which only a person can choose."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from igrip.lab.tuning.outcomes import Outcomes
from igrip.lab.tuning.search import Numbers


class Point(NamedTuple):
    """A configuration, and what it does on all trials.

    Attributes
    ----------
    values : mapping of str to float
        Its numbers.
    committed : float
        Share of reaches with a commitment before their end.
    right : float or None
        Share of these that were first committed to the target; None: there are none.
    part : float
        Mean part of the movement at the first commitment; a reach without one counts as 1.
    wrong : float
        Wrong commitments per trial.
    false_per_minute : float or None
        Leases that began in a minute without a reach; None: there is no such recording.
    """

    values: dict[str, float]
    committed: float
    right: float | None
    part: float
    wrong: float
    false_per_minute: float | None


def point(values: Mapping[str, float], outcomes: Outcomes, idle_minutes: float) -> Point:
    """Return what a configuration does, with the minutes of the trials without a reach."""
    reach, committed = outcomes.reaches, outcomes.committed
    return Point(
        values=dict(values),
        committed=float(committed[reach].mean()),
        right=float(outcomes.right[committed].mean()) if committed.any() else None,
        part=float(np.nan_to_num(outcomes.part[reach], nan=1.0).mean()),
        wrong=float(outcomes.wrong().mean()),
        false_per_minute=float(outcomes.false[~reach].sum()) / idle_minutes
        if idle_minutes > 0.0 else None,
    )  # fmt: skip


def front(known: Mapping[Numbers, Outcomes], idle_minutes: float) -> list[Point]:
    """Return the points than which none is both earlier and less often wrong.

    From reliable to reactive. Of several with as many wrong commitments it is the earliest; of
    equals the first.
    """
    points = [point(dict(values), outcomes, idle_minutes) for values, outcomes in known.items()]
    best: list[Point] = []
    for one in sorted(points, key=lambda p: (p.wrong, p.part)):
        if not best or one.part < best[-1].part - 1e-9:
            best.append(one)
    return best
