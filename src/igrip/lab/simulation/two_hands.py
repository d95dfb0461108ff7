"""Scenes of two hands: passes, handovers, two-handed lifts, and one hand to each of two objects.

Hands move as in the cohort (:mod:`igrip.lab.simulation.movement`). Whoever gives an object brings
it to a place of exchange, the receiver takes it there, both hold it for a moment, and the giver
lets go. Both hands of a lift set out together but for some tens of milliseconds (Kelso, Southard &
Goodman 1979, Science 203:1029-1031).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from igrip.lab.evaluation.movement import movement_bounds
from igrip.lab.simulation.minimum_jerk import Array
from igrip.lab.simulation.movement import Habits, draw_reach, sway, tremor
from igrip.lab.simulation.parameters import CohortParameters
from igrip.lab.simulation.sensors import Poses
from igrip.lab.simulation.table import Table, stand_at
from igrip.lab.simulation.two_hands_scene import Course, Hold, Reach, TwoHandsScene
from igrip.objects.model import ObjectModel
from igrip.settings import Settings, quantity

KINDS = ("pass", "handover", "lift", "each")
BOX_ID, BOX = "box", "box:0.30x0.20x0.18"  # too wide for one hand
OTHER = "other"  # the hand of another person
SIDES = {"left": -1.0, "right": 1.0}
FINE = 200.0  # Hz of the true trace in which onset and end are found


class TwoHandsParameters(Settings):
    """What the hands do, besides the parameters of the cohort."""

    onset_spread: float = quantity(
        0.06, "s", "sd between the onsets of the hands of a lift", "Kelso et al. 1979: nearly none",
        ge=0,
    )  # fmt: skip
    wide: float = quantity(0.7, "1", "how often the wide box is lifted", "guess", ge=0, le=1)
    in_hand: float = quantity(
        0.5, "1", "how often the giver has the object from the beginning", "guess", ge=0, le=1
    )
    begin: float = quantity(
        0.5, "1", "part of the bringing at which the receiver sets out, mean", "guess"
    )
    begin_spread: float = quantity(0.35, "1", "its sd", "guess", ge=0)
    overlap: float = quantity(0.15, "s", "both hold what is passed, at least", "guess", ge=0)
    overlap_spread: float = quantity(0.35, "s", "longer, uniform up to this", "guess", ge=0)
    ordered: float = quantity(
        0.8, "1", "how often each of two hands takes the object on its own side", "guess", ge=0
    )
    gap: float = quantity(0.03, "m", "between objects on the table, at least", "guess", ge=0)
    room: float = quantity(
        0.09, "m", "other objects are this far from where a palm takes one, at least",
        "a hand that goes through things is none", ge=0,
    )  # fmt: skip
    lift: float = quantity(0.18, "m", "height to which two hands lift", "guess", ge=0)


class _Stage:
    """One scene in the making."""

    def __init__(
        self, table: Table, cohort: CohortParameters, habits: Habits, two: TwoHandsParameters,
        random: np.random.Generator,
    ) -> None:  # fmt: skip
        self.table, self.cohort, self.habits, self.two = table, cohort, habits, two
        self.random = random
        protocol = cohort.protocol
        self.courses = {
            side: Course(
                np.array([sign * protocol.rest_aside, 0.0, protocol.rest_height])
                + random.normal(0.0, 0.012, 3) * [1, 1, 0.3]
            )
            for side, sign in SIDES.items()
        }
        self.onset = protocol.rest + random.uniform(0.0, protocol.rest_spread)
        self.reaches: list[Reach] = []
        self.goals: list[tuple[str, Array]] = []
        self.holds: list[Hold] = []
        self.moving: dict[str, Poses] = {}

    def has_room(self) -> bool:
        """Return whether no palm ends a reach in or nearly in an object that it does not take."""
        for target, goal in self.goals:
            for id, model in self.table.models.items():
                points = model.vertices[::16] @ self.table.rotation(id).T + self.table.places[id]
                nearest = float(np.linalg.norm(points - goal, axis=1).min())
                if id != target and nearest < self.two.room:
                    return False
        return True

    def move(self, hand: str, goal: Array, onset: float, target: str | None = None) -> float:
        """Let a hand move on to a goal, (3,) [m], from a time on; return when it is there [s].

        With a ``target``, it is a reach for that object.
        """
        course = self.courses[hand]
        one = draw_reach(
            self.cohort.person, self.habits, course.point(onset), goal, onset, None, self.random
        )
        course.parts.append(one)
        if target is not None:
            self.goals.append((target, goal))
            fine = np.arange(max(0.0, onset - 0.2), one.end + 0.2, 1.0 / FINE)
            speeds = np.linalg.norm(np.gradient(one.position(fine), 1.0 / FINE, axis=0), axis=1)
            bounds = movement_bounds(fine, speeds)
            assert bounds is not None, "a reach has a peak between rest and rest"
            self.reaches.append(Reach(hand, target, *bounds))
        return one.end

    def carry(self, id: str, origin: Callable[[float], Array]) -> None:
        """Let an object be where ``origin`` says at each time."""
        rotation = self.table.rotation(id)
        self.moving[id] = lambda t: (rotation, origin(t))

    def scene(self, kind: str, end: float) -> TwoHandsScene:
        """Return the scene, which lasts until some time after ``end`` [s]."""
        protocol, person = self.cohort.protocol, self.cohort.person
        times = np.arange(0.0, end + protocol.hold, 1.0 / protocol.rate)
        palms = {
            hand: course.at(times) + sway(person, times, self.random)
            + tremor(person, times, self.random)
            for hand, course in self.courses.items()
        }  # fmt: skip
        return TwoHandsScene(
            kind, times, palms, self.table, self.moving, self.reaches, self.holds
        )  # fmt: skip


def draw_scene(
    kind: str,
    models: Mapping[str, ObjectModel],
    cohort: CohortParameters,
    habits: Habits,
    random: np.random.Generator,
    two: TwoHandsParameters | None = None,
) -> TwoHandsScene:
    """Draw one scene of a kind (:data:`KINDS`).

    Parameters
    ----------
    kind : str
        ``pass``: from one hand to the other; ``handover``: from another person's hand;
        ``lift``: both hands take one object; ``each``: each hand takes another object.
    models : mapping of str to ObjectModel
        By id; that of :data:`BOX_ID` is the wide one.
    cohort, habits : CohortParameters, Habits
        The person.
    random : Generator
        Fixes all that is drawn.
    two : TwoHandsParameters, optional
        What the hands do.
    """
    two = two or TwoHandsParameters()
    act = {"lift": _lift, "each": _each}.get(kind, _pass)
    while True:
        stage = _Stage(set_wide_table(models, cohort, two, random), cohort, habits, two, random)
        end = act(stage, kind)
        if stage.has_room():
            return stage.scene(kind, end)


def set_wide_table(
    models: Mapping[str, ObjectModel],
    cohort: CohortParameters,
    two: TwoHandsParameters,
    random: np.random.Generator,
) -> Table:
    """Place the wide box and three other objects at random, none touching another."""
    others = [id for id in models if id != BOX_ID]
    chosen = [BOX_ID, *(others[k] for k in sorted(random.permutation(len(others))[:3]))]
    size = {id: float(np.ptp(models[id].vertices[:, :2], axis=0).max()) for id in chosen}
    half, protocol = 0.5 * cohort.protocol.table_width, cohort.protocol
    while True:
        spots: dict[str, Array] = {}
        for id in chosen:
            for _ in range(100):
                spot = random.uniform(
                    [-half, protocol.table_near + 0.04], [half, protocol.table_far + 0.04]
                )
                if all(
                    np.linalg.norm(spot - place) >= 0.5 * (size[id] + size[other]) + two.gap
                    for other, place in spots.items()
                ):
                    spots[id] = spot
                    break
        if len(spots) < len(chosen):
            continue  # an unlucky beginning: there is no room left; begin anew
        yaws = {id: float(random.uniform(-math.pi, math.pi)) for id in chosen}
        yaws[BOX_ID] = float(random.normal(0.0, 0.2))  # its long side lies across
        places = {id: stand_at(models[id], spots[id], yaws[id]) for id in chosen}
        return Table({id: models[id] for id in chosen}, places, yaws)


def _lift(stage: _Stage, kind: str) -> float:
    """Let both hands take one object by its sides and lift it; return when they stop [s]."""
    two, random, table = stage.two, stage.random, stage.table
    others = [id for id in table.models if id != BOX_ID]
    id = BOX_ID if random.random() < two.wide else others[int(random.integers(len(others)))]
    arrived = []
    for hand, sign in SIDES.items():
        beside = table.middle(id) + np.array([sign, random.normal(0.0, 0.2), 0.0])
        goal = table.grasp_point(id, "palmar", beside, stage.cohort.protocol)
        onset = stage.onset + abs(random.normal(0.0, two.onset_spread))
        arrived.append(stage.move(hand, goal, onset, id))
    begin = max(arrived) + random.uniform(0.1, 0.4)
    way = np.array([random.normal(0.0, 0.05), random.uniform(-0.15, 0.05), two.lift])
    # both hands and the object make the same movement
    start = stage.courses["left"].point(begin)
    stop = stage.move("left", start + way, begin)
    lifting = stage.courses["left"].parts[-1]
    stage.courses["right"].parts.append(lifting)
    place = table.places[id]
    stage.carry(id, lambda t: place + lifting.position(np.array([t]))[0] - lifting.start)
    stage.holds += [Hold(hand, id, max(arrived), math.inf) for hand in SIDES]
    return stop


def _each(stage: _Stage, kind: str) -> float:
    """Let each hand take another object; return when both are there [s]."""
    random, table = stage.random, stage.table
    ids = [id for id in table.models if id != BOX_ID]  # one hand cannot take that
    pair = [ids[k] for k in random.permutation(len(ids))[:2]]
    if random.random() < stage.two.ordered:
        pair.sort(key=lambda id: float(table.middle(id)[0]))
    end = 0.0
    for hand, id in zip(SIDES, pair, strict=True):
        goal = table.grasp_point(
            id, "palmar", stage.courses[hand].start, stage.cohort.protocol
        )  # fmt: skip
        onset = stage.onset + random.uniform(0.0, 0.4)
        arrived = stage.move(hand, goal, onset, id)
        stage.holds.append(Hold(hand, id, arrived, math.inf))
        end = max(end, arrived)
    return end


def _pass(stage: _Stage, kind: str) -> float:
    """Let a giver bring an object to a receiver, who takes it; return when it is away [s]."""
    two, random, table, protocol = stage.two, stage.random, stage.table, stage.cohort.protocol
    receiver, giver = [list(SIDES)[k] for k in random.permutation(2)]
    if kind == "handover":
        giver = OTHER
        stage.courses[OTHER] = Course(random.uniform([-0.3, 0.8, 0.04], [0.3, 0.95, 0.15]))
    others = [id for id in table.models if id != BOX_ID]
    id = others[int(random.integers(len(others)))]
    course = stage.courses[giver]
    grasp = table.grasp_point(id, "palmar", course.start, protocol)
    offset = table.places[id] - grasp  # of the object's origin from the giver's palm
    since, begin = 0.0, stage.onset
    if random.random() < two.in_hand:
        course.start = course.start + [0.0, 0.0, 0.5 * table.models[id].length]
        table = stage.table = replace(table, places={**table.places, id: course.start + offset})
    else:
        since = stage.move(giver, grasp, begin, id)
        begin = since + random.uniform(0.1, 0.4)
    before = table.places[id]
    exchange = random.uniform([-0.15, 0.22, 0.15], [0.15, 0.42, 0.35])
    middle = table.middle(id) - before  # from the object's origin to its middle
    brought = stage.move(giver, exchange - middle - offset, begin)
    there = course.point(brought) + offset
    at_exchange = replace(table, places={**table.places, id: there})
    goal = at_exchange.grasp_point(id, "palmar", stage.courses[receiver].start, protocol)
    part = random.normal(two.begin, two.begin_spread)
    taken = stage.move(receiver, goal, max(0.4, begin + part * (brought - begin)), id)
    released = max(brought, taken) + two.overlap + random.uniform(0.0, two.overlap_spread)
    stage.move(giver, course.start, released + random.uniform(0.0, 0.15))
    away = stage.courses[receiver].start + [0.0, 0.05, random.uniform(0.1, 0.2)]
    stop = stage.move(receiver, away, released + random.uniform(0.1, 0.4))
    own = stage.courses[receiver]
    after = course.point(released) + offset - own.point(released)

    def origin(t: float) -> Array:
        if t < since:
            return before
        carried: Array = course.point(t) + offset if t < released else own.point(t) + after
        return carried

    stage.carry(id, origin)
    stage.holds += [
        Hold(giver, id, since, released), Hold(receiver, id, max(brought, taken), math.inf)
    ]  # fmt: skip
    return stop
