"""Minutes without a reach: idle hands, gestures, passing by, carrying objects about."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from igrip.lab.simulation.minimum_jerk import Array, reach
from igrip.lab.simulation.movement import sway, tremor
from igrip.lab.simulation.parameters import CohortParameters
from igrip.lab.simulation.sensors import Poses
from igrip.lab.simulation.table import Table

KINDS = ("idle", "gesture", "passing", "carrying")


@dataclass(frozen=True)
class NoReach:
    """A scene in which nothing is reached for."""

    times: Array  # of the frames, (n,) [s]
    palms: Mapping[str, Array]  # both palms, (n, 3) [m]
    hand: str  # the one that moves most
    moving: Mapping[str, Poses]  # objects that do not rest


def draw_no_reach(
    kind: str,
    table: Table,
    cohort: CohortParameters,
    rest: Mapping[str, Array],
    seconds: float,
    random: np.random.Generator,
) -> NoReach:
    """Draw one scene of a kind (:data:`KINDS`) that lasts some seconds; palms rest at (3,) [m]."""
    times = np.arange(0.0, seconds, 1.0 / cohort.protocol.rate)
    hand = ("left", "right")[int(random.integers(2))]
    palms = {
        side: rest[side] + sway(cohort.person, times, random) + tremor(cohort.person, times, random)
        for side in rest
    }
    moving: dict[str, Poses] = {}
    if kind == "idle":
        for side in rest:  # small adjustments of the posture
            palms[side] += _wander(times, 6.0, lambda: random.normal(0.0, 0.02, 3), random)
    elif kind == "gesture":
        low, high = np.array([-0.15, 0.0, 0.08]), np.array([0.15, 0.14, 0.35])
        palms[hand] += _wander(times, 1.6, lambda: random.uniform(low, high), random)
    elif kind == "passing":
        palms[hand] = _pass_by(times, rest[hand], random) + palms[hand] - rest[hand]
    else:
        id = list(table.models)[int(random.integers(len(table.models)))]
        held = table.grasp_point(id, "palmar", rest[hand], cohort.protocol)
        way = _wander(
            times, 2.2, lambda: random.uniform([-0.2, -0.2, 0.03], [0.2, 0.1, 0.2]), random
        )
        palms[hand] = held + way + palms[hand] - rest[hand]
        rotation, place = table.rotation(id), table.places[id]

        def carried(t: float) -> tuple[Array, Array]:
            moved = [np.interp(t, times, way[:, axis]) for axis in range(3)]
            return rotation, place + np.array(moved)

        moving[id] = carried
    return NoReach(times, palms, hand, moving)


def _wander(
    times: Array, pause: float, draw: Callable[[], Array], random: np.random.Generator
) -> Array:
    """Return a walk of minimum-jerk moves between drawn points, with pauses, shape (n, 3) [m]."""
    walk = np.zeros((len(times), 3))
    here, t = np.zeros(3), float(random.uniform(0.3, 1.0 + pause))
    while t < times[-1]:
        there = draw()
        lasts = float(random.uniform(0.6, 1.2))
        after = times >= t
        walk[after] = reach(here, there, 0.0, (times[after] - t) / lasts)
        here, t = there, t + lasts + float(random.exponential(0.5 * pause))
    return walk


def _pass_by(times: Array, rest: Array, random: np.random.Generator) -> Array:
    """Return a hand that goes through the scene over the objects and back, again and again."""
    path = np.tile(rest, (len(times), 1))
    t = float(random.uniform(0.5, 2.0))
    while t < times[-1]:
        far = np.array(
            [-np.sign(rest[0]) * random.uniform(0.2, 0.5), random.uniform(0.1, 0.6), 0.3]
        )
        lasts, stays = float(random.uniform(1.0, 1.8)), float(random.uniform(0.2, 0.8))
        after = times >= t
        path[after] = reach(rest, far, 0.08, (times[after] - t) / lasts)
        back = times >= t + lasts + stays
        path[back] = reach(far, rest, 0.08, (times[back] - t - lasts - stays) / lasts)
        t += 2.0 * lasts + stays + float(random.uniform(0.5, 2.5))
    return path
