"""The experiment of the paper, on a computer: people, trials, cameras, written as a dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.datasets.dataset import DatasetWriter, Trial
from igrip.lab.evaluation.movement import movement_bounds
from igrip.lab.simulation.movement import Habits, draw_habits, draw_reach, sway, tremor
from igrip.lab.simulation.no_reach import KINDS, draw_no_reach
from igrip.lab.simulation.parameters import Cohort, Protocol, checksum
from igrip.lab.simulation.sensors import film, place_camera
from igrip.lab.simulation.table import Table, set_table
from igrip.objects.catalog import PAPER_OBJECTS, Catalog
from igrip.objects.model import ObjectModel
from igrip.observation import Observation

Array = NDArray[np.float64]
SIDES = ("left", "right")
FINE = 200.0  # Hz of the true trace in which onset and end are found


@dataclass(frozen=True)
class Task:
    """One row of the protocol."""

    hand: str
    target: str
    grip: str
    movement: str


def tasks_of(protocol: Protocol, random: np.random.Generator) -> list[Task]:
    """Return the shuffled trials of one participant."""
    rows = [
        Task(hand, target, grip, movement)
        for hand, target, grip, movement, _ in product(
            SIDES, object_ids(), ("palmar", "pinch"), ("executed", "simulated"),
            range(protocol.repetitions),
        )
    ]  # fmt: skip
    return [rows[k] for k in random.permutation(len(rows))]


def object_ids() -> list[str]:
    """Return the ids of the paper's objects in the recordings."""
    return [name.split("_")[-2] for name in PAPER_OBJECTS]


def models_by_id(catalog: Catalog) -> dict[str, ObjectModel]:
    """Return the paper's objects."""
    return {id: catalog[name] for id, name in zip(object_ids(), PAPER_OBJECTS, strict=True)}


def rest_points(protocol: Protocol) -> dict[str, Array]:
    """Return where each palm rests [m]."""
    return {
        side: np.array([sign * protocol.rest_aside, 0.0, protocol.rest_height])
        for side, sign in (("left", -1.0), ("right", 1.0))
    }


@dataclass(frozen=True)
class Performance:
    """What truly happened in one trial; both cameras see the same.

    Attributes
    ----------
    times : (n,)
        Of the frames [s].
    palms : dict of str to (n, 3)
        Both palms [m].
    table : Table
        The objects.
    bounds : (float, float)
        Onset and end of the movement [s].
    """

    times: Array
    palms: Mapping[str, Array]
    table: Table
    bounds: tuple[float, float]


def perform(
    task: Task,
    cohort: Cohort,
    habits: Habits,
    models: Mapping[str, ObjectModel],
    random: np.random.Generator,
) -> Performance:
    """Let a participant do one task."""
    protocol, person = cohort.protocol, cohort.person
    table = set_table(models, protocol, random)
    rest = rest_points(protocol)
    starts = {
        side: point + random.normal(0.0, 0.012, 3) * [1, 1, 0.3] for side, point in rest.items()
    }
    goal = table.grasp_point(task.target, task.grip, starts[task.hand], protocol)
    if task.movement == "simulated":
        way = goal - starts[task.hand]
        goal = goal - abs(random.normal(0.0, protocol.simulated_short)) * way / np.linalg.norm(way)
    others = [id for id in models if id != task.target]
    second = others[int(random.integers(len(others)))]
    other = table.grasp_point(second, task.grip, starts[task.hand], protocol)
    onset = protocol.rest + random.uniform(0.0, protocol.rest_spread)
    reach = draw_reach(person, habits, starts[task.hand], goal, onset, other, random)
    times = np.arange(0.0, reach.end + protocol.hold, 1.0 / protocol.rate)
    palms = {
        side: starts[side] + sway(person, times, random) + tremor(person, times, random)
        for side in SIDES
    }
    palms[task.hand] += reach.position(times) - starts[task.hand]
    fine = np.arange(0.0, times[-1], 1.0 / FINE)
    speeds = np.linalg.norm(np.gradient(reach.position(fine), 1.0 / FINE, axis=0), axis=1)
    bounds = movement_bounds(fine, speeds)
    assert bounds is not None, "a reach has a peak between rest and rest"
    return Performance(times, palms, table, bounds)


def simulate(
    path: str | Path,
    catalog: Catalog,
    cohort: Cohort,
    participants: int = 11,
    seed: int = 0,
    trials: int | None = None,
    no_reach_minutes: int = 30,
) -> Iterator[tuple[int, int]]:
    """Write a cohort as a dataset, and say how many recordings are done, and of how many.

    Parameters
    ----------
    path : str or Path
        A new folder.
    catalog : Catalog
        Must hold the paper's objects.
    cohort : Cohort
        All parameters.
    participants, seed : int
        How many people, and which.
    trials : int, optional
        Only the first so many trials of each participant.
    no_reach_minutes : int
        Minutes without any reach, a recording each.

    Raises
    ------
    DatasetError
        If the folder holds something already.
    """
    if participants < 1:
        raise DatasetError("a cohort needs a participant")
    models = models_by_id(catalog)
    source = (
        f"igrip simulate --participants {participants} --seed {seed} --profile {cohort.profile}; "
        f"parameters {checksum(cohort)}"
    )
    details: dict[str, Any] = {"objects": ["ycb"], "simulated": cohort.model_dump(mode="json")}
    with DatasetWriter(path, f"simulated {cohort.profile}", "CC0-1.0", source, **details) as writer:
        done, total = 0, 0
        plans = []
        for p in range(participants):
            random = np.random.default_rng([seed, p, 0])
            habits, tasks = draw_habits(cohort.person, random), tasks_of(cohort.protocol, random)
            cameras = {side: place_camera(cohort.camera, side, random) for side in SIDES}
            plans.append((habits, tasks[:trials], cameras))
            total += 2 * len(tasks[:trials])
        total += no_reach_minutes
        for p, (habits, tasks, cameras) in enumerate(plans):
            for number, task in enumerate(tasks, start=1):
                random = np.random.default_rng([seed, p, 1, number])
                performance = perform(task, cohort, habits, models, random)
                for row, messages in _recordings(
                    p, number, task, performance, cohort, cameras, seed
                ):
                    writer.add(row, messages)
                    done += 1
                    yield done, total
        for minute in range(no_reach_minutes):
            p = minute % participants
            writer.add(*_no_reach(minute, p, cohort, plans[p][2], models, seed))
            done += 1
            yield done, total
        people = {f"p{p + 1:02d}": {"profile": cohort.profile} for p in range(participants)}
        writer.close(people)


def _recordings(
    p: int,
    number: int,
    task: Task,
    performance: Performance,
    cohort: Cohort,
    cameras: Mapping[str, Array],
    seed: int,
) -> Iterator[tuple[Trial, list[Observation]]]:
    onset, end = performance.bounds
    for c, side in enumerate(SIDES):
        random = np.random.default_rng([seed, p, 2, number, c])
        messages = film(
            performance.times, performance.palms, performance.table, cameras[side], cohort.camera,
            random,
        )  # fmt: skip
        row = Trial(
            recording=f"p{p + 1:02d}_t{number:03d}_{side}",
            participant=f"p{p + 1:02d}", trial=str(number), camera=f"camera_{side}",
            camera_side=side, hand=task.hand, target=task.target, grip=task.grip,
            movement=task.movement, onset_s=round(onset, 4), end_s=round(end, 4), performed="yes",
        )  # fmt: skip
        yield row, messages


def _no_reach(
    minute: int,
    p: int,
    cohort: Cohort,
    cameras: Mapping[str, Array],
    models: Mapping[str, ObjectModel],
    seed: int,
) -> tuple[Trial, list[Observation]]:
    random = np.random.default_rng([seed, p, 3, minute])
    kind, side = KINDS[minute % len(KINDS)], SIDES[minute // len(KINDS) % 2]
    table = set_table(models, cohort.protocol, random)
    scene = draw_no_reach(kind, table, cohort, rest_points(cohort.protocol), 60.0, random)
    messages = film(
        scene.times, scene.palms, table, cameras[side], cohort.camera, random, scene.moving
    )
    row = Trial(
        recording=f"p{p + 1:02d}_none{minute + 1:02d}_{side}", participant=f"p{p + 1:02d}",
        trial=f"none{minute + 1}", camera=f"camera_{side}", camera_side=side, hand=scene.hand,
        target="none", movement=kind,
    )  # fmt: skip
    return row, messages
