"""Simulated handovers: another person brings an object, and the hand meets it on its way.

Independent of both generators of reaches for objects that stand: a giver carries one object from
their side of a table to a place of exchange and holds it there; the receiver's hand leaves before,
while or after it moves, with the movements of :mod:`training.arm_movement`. Poses of objects come
at their own rate and late. ``training/strangers.py`` judges by other people of this generator, and
``training/leave_one_out.py`` by an estimator that learned without it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.entities import ObjectPose
from igrip.lab.simulation.minimum_jerk import progress
from igrip.observation import Observation
from training.arm_movement import STEP, Arm, draw_arm, move
from training.arms import find_bounds
from training.moments import THINGS, Recording, catalog

Array = NDArray[np.float64]
TRIALS = 8  # of each person
STANDING = (0, 1, 2, 3, 3, 3, 4, 6)  # objects that stand on the table
HAND_RATES = (10.0, 15.0, 30.0, 30.0, 60.0)  # Hz
OBJECT_RATES = (8.0, 10.0, 10.0, 15.0, 30.0)  # Hz
GRASP_GAP = 0.05  # m, at most between palm and surface at the end
APART = 0.12  # m, between objects at least
MODES = ("handover",) * 6 + ("beside",) * 2 + ("carrying",) * 2


class Sensors(NamedTuple):
    """How hands and objects are measured: rates [Hz], noise [m], latency [s]."""

    hand_rate: float
    object_rate: float
    noise: float
    latency: float
    jitter: float
    stamped: bool  # whether late poses say when they were measured


class Scene(NamedTuple):
    """The palm and the object that is brought, (n, 3) [m], and what stands."""

    palm: Array
    brought: Array
    stand: Sequence[Array]
    models: Sequence[str]


def simulate_handovers(seed: int, number: int) -> list[Recording]:
    """Return the recordings of one drawn person.

    Most are handovers. In the others they reach for an object that stands while somebody moves
    another, or their own hand carries the object: that is no reach.
    """
    random = np.random.default_rng([seed, number, 3])
    arm = draw_arm(random)
    sensors = Sensors(
        float(random.choice(HAND_RATES)), float(random.choice(OBJECT_RATES)),
        float(random.choice([0.0, 0.002, 0.004])), random.uniform(0.0, 0.12),
        random.uniform(0.0, 0.003), bool(random.random() < 0.5),
    )  # fmt: skip
    recordings = []
    for _ in range(TRIALS):
        recording = _trial(f"h{number}", arm, sensors, str(random.choice(MODES)), random)
        if recording is not None:
            recordings.append(recording)
    return recordings


def _trial(
    person: str, arm: Arm, sensors: Sensors, mode: str, random: np.random.Generator
) -> Recording | None:
    models = [THINGS[int(k)] for k in random.integers(len(THINGS), size=1 + max(STANDING))]
    exchange = random.uniform([-0.25, 0.3, 0.1], [0.25, 0.65, 0.45])
    start = random.uniform([-0.35, -0.1, -0.02], [0.35, 0.15, 0.15])
    if arm.planar:
        exchange[2] = start[2] = 0.0
    stand = _standing(int(random.choice(STANDING)), exchange, start, arm.plane, random)
    brought = _bring(exchange, arm.plane, random)
    target = 0
    if mode == "beside":
        if not stand:
            return None
        target = 1 + int(random.integers(len(stand)))
    goal = exchange if target == 0 else stand[target - 1]
    aside = start - goal + random.normal(0.0, 0.15, 3) * arm.plane
    gap = catalog()[models[target]].radius + random.uniform(0.0, GRASP_GAP)
    reach = move(arm, start, goal + gap * aside / np.linalg.norm(aside), random)
    # most receivers begin while the object moves; some wait for it, some it waits for
    begin = max(0, int(random.normal(0.5, 0.35) * len(brought)))
    if mode == "carrying":
        palm, bounds = brought + gap * aside / np.linalg.norm(aside), (math.inf, math.inf)
    else:
        palm = np.concatenate([np.tile(start, (begin, 1)), reach])
        found = find_bounds(palm, begin, len(palm) - 1)
        if found is None:
            return None
        bounds = found
    length = max(len(palm), len(brought)) + int(0.3 / STEP)
    scene = Scene(_held(palm, length), _held(brought, length), stand, models)
    recording = Recording(
        person, mode, record_scene(scene, sensors, random), "right",
        None if mode == "carrying" else f"o{target}", *bounds, math.inf, sensors.hand_rate,
    )  # fmt: skip
    return recording


def _bring(exchange: Array, plane: Array, random: np.random.Generator) -> Array:
    """Return the path of the middle of the object, up to where the hand takes it, (n, 3)."""
    away = random.uniform([-0.3, 0.25, -0.3], [0.3, 0.6, 0.1]) * plane
    lasts = random.uniform(0.6, 1.8)
    times = np.arange(0.0, lasts, STEP)
    done = progress(times / lasts)[:, None]
    lift = random.uniform(0.0, 0.15) * 4.0 * done * (1.0 - done) * [0.0, 0.0, plane[2]]
    wait = int(random.uniform(0.0, 0.5) / STEP)
    path = np.concatenate(
        [np.tile(exchange + away, (wait, 1)), exchange + away * (1 - done) + lift]
    )
    # it drifts towards the receiver and sways in the giver's hand
    sway = random.uniform(0.0, 0.006) * np.sin(
        np.arange(len(path))[:, None] * STEP * random.uniform(2.0, 9.0, 3) + random.uniform(0, 6, 3)
    )
    result: Array = path + sway * plane
    return result


def _held(path: Array, length: int) -> Array:
    return np.concatenate([path, np.tile(path[-1], (length - len(path), 1))])


def _standing(
    count: int, exchange: Array, start: Array, plane: Array, random: np.random.Generator
) -> list[Array]:
    """Return where the other objects stand."""
    places: list[Array] = []
    for _ in range(50 * count):
        place = random.uniform([-0.5, 0.2, -0.02], [0.5, 0.9, 0.12]) * plane
        if all(np.linalg.norm(place - p) > APART for p in [exchange, start, *places]):
            places.append(place)
        if len(places) == count:
            break
    return places


def record_scene(scene: Scene, sensors: Sensors, random: np.random.Generator) -> list[Observation]:
    """Return a scene as sensors see it."""
    times = np.arange(len(scene.palm)) * STEP

    def at(path: Array, t: float) -> Array:
        point: Array = np.array([np.interp(t, times, path[:, axis]) for axis in range(3)])
        return point

    def pose(k: int, place: Array, measured: float | None = None) -> ObjectPose:
        model = catalog()[scene.models[k]]
        x, y, z = (place - model.origin).tolist()
        return ObjectPose(
            model=model.name, position=(x, y, z), orientation=(0, 0, 0, 1), static=k > 0,
            t=measured,
        )  # fmt: skip

    messages: list[Observation] = []
    due = 0.0
    standing = {f"o{k}": pose(k, place) for k, place in enumerate(scene.stand, 1)}
    for t in (np.arange(int(times[-1] * sensors.hand_rate) + 1) / sensors.hand_rate).tolist():
        seen = at(scene.palm, t) + random.normal(0.0, sensors.noise, 3)
        objects = dict(standing) if not messages else {}
        if t >= due:
            due = t + 1.0 / sensors.object_rate
            place = at(scene.brought, t - sensors.latency) + random.normal(0.0, sensors.jitter, 3)
            objects["o0"] = pose(
                0, place, max(0.0, t - sensors.latency) if sensors.stamped else None
            )
        messages.append(
            Observation(t=t, hands={"right": {"position": seen.tolist()}}, objects=objects)
        )
    return messages
