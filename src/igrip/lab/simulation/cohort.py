"""The experiment of the paper, on a computer: people, trials, cameras, written as a dataset."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from functools import lru_cache, partial
from itertools import accumulate, product
from pathlib import Path
from typing import Any

import numpy as np

from igrip.errors import DatasetError
from igrip.io.datasets.dataset import Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.lab.evaluation.movement import movement_bounds
from igrip.lab.parallel import ALONE, Workers, count_jobs
from igrip.lab.simulation.minimum_jerk import Array
from igrip.lab.simulation.movement import Habits, draw_habits, draw_reach, sway, tremor
from igrip.lab.simulation.no_reach import KINDS, draw_no_reach
from igrip.lab.simulation.parameters import CohortParameters, ProtocolParameters, checksum
from igrip.lab.simulation.sensors import observe_scene, place_camera
from igrip.lab.simulation.table import Table, models_by_id, object_ids, set_table
from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.observation import Observation
from igrip.version import __version__

SIDES = ("left", "right")
FINE = 200.0  # Hz of the true trace in which onset and end are found


@dataclass(frozen=True)
class TrialTask:
    """One row of the protocol."""

    hand: str
    target: str
    grip: str
    movement: str


def tasks_of(protocol: ProtocolParameters, random: np.random.Generator) -> list[TrialTask]:
    """Return the shuffled trials of one participant."""
    rows = [
        TrialTask(hand, target, grip, movement)
        for hand, target, grip, movement, _ in product(
            SIDES, object_ids(), ("palmar", "pinch"), ("executed", "simulated"),
            range(protocol.repetitions),
        )
    ]  # fmt: skip
    return [rows[k] for k in random.permutation(len(rows))]


def rest_points(protocol: ProtocolParameters) -> dict[str, Array]:
    """Return where each palm rests [m]."""
    return {
        side: np.array([sign * protocol.rest_aside, 0.0, protocol.rest_height])
        for side, sign in (("left", -1.0), ("right", 1.0))
    }


@dataclass(frozen=True)
class PerformedTask:
    """What truly happened in one trial; both cameras see the same."""

    times: Array  # of the frames, (n,) [s]
    palms: Mapping[str, Array]  # both palms, (n, 3) [m]
    table: Table
    bounds: tuple[float, float]  # onset and end of the movement [s]


def perform(
    task: TrialTask,
    cohort: CohortParameters,
    habits: Habits,
    models: Mapping[str, ObjectModel],
    random: np.random.Generator,
) -> PerformedTask:
    """Let a participant do one task, with the objects at random places."""
    table = set_table(models, cohort.protocol, random)
    return perform_at(task, table, cohort, habits, random)


def perform_at(
    task: TrialTask,
    table: Table,
    cohort: CohortParameters,
    habits: Habits,
    random: np.random.Generator,
) -> PerformedTask:
    """Let a participant do one task, with the objects where they stand."""
    protocol, person = cohort.protocol, cohort.person
    rest = rest_points(protocol)
    starts = {
        side: point + random.normal(0.0, 0.012, 3) * [1, 1, 0.3] for side, point in rest.items()
    }
    goal = table.grasp_point(task.target, task.grip, starts[task.hand], protocol)
    if task.movement == "simulated":
        way = goal - starts[task.hand]
        goal = goal - abs(random.normal(0.0, protocol.simulated_short)) * way / np.linalg.norm(way)
    others = [id for id in table.models if id != task.target]
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
    return PerformedTask(times, palms, table, bounds)


def simulate_cohort(
    path: str | Path,
    catalog: Catalog,
    parameters: CohortParameters,
    participants: int = 11,
    seed: int = 0,
    trials: int | None = None,
    no_reach_minutes: int = 30,
    workers: Workers = ALONE,
) -> Iterator[tuple[int, int]]:
    """Write a cohort to a new folder; yield how many recordings are done, and of how many.

    The catalog must hold the paper's objects. Only the first so many ``trials`` of each participant
    are done; each of the minutes without a reach is one recording. What is written does not depend
    on the ``workers``.

    Raises
    ------
    DatasetError
        If the folder holds something already.
    """
    if participants < 1:
        raise DatasetError("a cohort needs a participant")
    models = models_by_id(catalog)
    people = [Participant(parameters, p, seed, trials) for p in range(participants)]
    source = (
        f"igrip simulate --participants {participants} --seed {seed} "
        f"--profile {parameters.profile}; parameters {checksum(parameters)}"
    )
    details: dict[str, Any] = {"objects": ["ycb"], "simulated": parameters.model_dump(mode="json")}
    name = f"simulated {parameters.profile}"
    scenes = [(p, number) for p, person in enumerate(people) for number in range(len(person.tasks))]
    scenes += [(k % participants, ~k) for k in range(no_reach_minutes)]  # without a reach
    # how many recordings there are after each scene
    until = list(accumulate(len(SIDES) if number >= 0 else 1 for _, number in scenes))
    total = until[-1] if until else 0
    resume = f"{__version__}, {trials} trials, {total} recordings"
    with DatasetWriter(path, name, "CC0-1.0", source, resume, **details) as writer:
        done = len(writer.trials)  # an interrupted simulation goes on
        if done:
            yield done, total
        begin = bisect_right(until, done)
        half = done - until[begin - 1] if begin else done  # of a scene that was interrupted
        work = partial(_record, parameters, seed, trials, dict(models))
        shared = replace(workers, jobs=count_jobs(workers.jobs, len(scenes) - begin))
        for scene in shared.map(work, scenes[begin:]):
            for row, messages in scene[half:]:
                writer.add(row, messages)
                done += 1
                yield done, total
            half = 0
        writer.close({person.name: {"profile": parameters.profile} for person in people})


Recordings = list[tuple[Trial, list[Observation]]]


def _record(
    parameters: CohortParameters, seed: int, trials: int | None, models: Mapping[str, ObjectModel],
    scene: tuple[int, int],
) -> Recordings:  # fmt: skip
    """Return the recordings of one scene: person, and trial or, inverted, minute."""
    person, number = scene
    participant = _participant(parameters.model_dump_json(), person, seed, trials)
    if number < 0:
        return [participant.record_no_reach(~number, models)]
    return participant.record_trial(number, models)


@lru_cache(maxsize=8)
def _participant(parameters: str, number: int, seed: int, trials: int | None) -> Participant:
    return Participant(CohortParameters.model_validate_json(parameters), number, seed, trials)


class Participant:
    """One simulated participant, with the two cameras that stand before them.

    ``number`` (from 0) and ``seed`` (of the cohort) fix all that is drawn; only the first so many
    ``trials`` are done.
    """

    def __init__(
        self, parameters: CohortParameters, number: int, seed: int, trials: int | None
    ) -> None:
        self._parameters, self._seed = parameters, (seed, number)
        self.name = f"p{number + 1:02d}"
        random = np.random.default_rng([*self._seed, 0])
        self._habits = draw_habits(parameters.person, random)
        self.tasks = tasks_of(parameters.protocol, random)[:trials]
        self._cameras = {side: place_camera(parameters.camera, side, random) for side in SIDES}

    def record_trial(self, index: int, models: Mapping[str, ObjectModel]) -> Recordings:
        """Return row and messages of a trial (from 0), as each camera observes it."""
        number, task = index + 1, self.tasks[index]
        random = np.random.default_rng([*self._seed, 1, number])
        done = perform(task, self._parameters, self._habits, models, random)
        onset, end = done.bounds
        recordings: Recordings = []
        for c, side in enumerate(SIDES):
            messages = observe_scene(
                done.times, done.palms, done.table, self._cameras[side], self._parameters.camera,
                np.random.default_rng([*self._seed, 2, number, c]),
            )  # fmt: skip
            row = Trial(
                recording=f"{self.name}_t{number:03d}_{side}", participant=self.name,
                trial=str(number), camera=f"camera_{side}", camera_side=side,
                **asdict(task), onset_s=round(onset, 4), end_s=round(end, 4), performed="yes",
            )  # fmt: skip
            recordings.append((row, messages))
        return recordings

    def record_no_reach(
        self, minute: int, models: Mapping[str, ObjectModel]
    ) -> tuple[Trial, list[Observation]]:
        """Return row and messages of a minute without a reach."""
        random = np.random.default_rng([*self._seed, 3, minute])
        kind, side = KINDS[minute % len(KINDS)], SIDES[minute // len(KINDS) % 2]
        protocol = self._parameters.protocol
        table = set_table(models, protocol, random)
        scene = draw_no_reach(kind, table, self._parameters, rest_points(protocol), 60.0, random)
        messages = observe_scene(
            scene.times, scene.palms, table, self._cameras[side], self._parameters.camera, random,
            scene.moving,
        )  # fmt: skip
        row = Trial(
            recording=f"{self.name}_none{minute + 1:02d}_{side}", participant=self.name,
            trial=f"none{minute + 1}", camera=f"camera_{side}", camera_side=side, hand=scene.hand,
            target="none", movement=kind,
        )  # fmt: skip
        return row, messages
