"""Scenes of two hands, written as a dataset: a row for each reach and camera."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from igrip.errors import DatasetError
from igrip.io.datasets.dataset import Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.lab.parallel import ALONE, Workers
from igrip.lab.simulation.movement import draw_habits
from igrip.lab.simulation.parameters import CohortParameters, checksum
from igrip.lab.simulation.sensors import observe_scene, place_camera
from igrip.lab.simulation.table import models_by_id
from igrip.lab.simulation.two_hands import BOX, BOX_ID, KINDS, SIDES, draw_scene
from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.observation import Observation

SCENES = 32  # of each participant: eight of each kind
OBJECTS = ("ycb", BOX)  # what its catalogue is made of
Recordings = list[tuple[Trial, list[Observation]]]


def simulate_two_hands(
    path: str | Path,
    catalog: Catalog,
    parameters: CohortParameters,
    participants: int = 11,
    seed: int = 0,
    scenes: int | None = None,
    workers: Workers = ALONE,
) -> Iterator[tuple[int, int]]:
    """Write scenes of two hands to a new folder; yield how many are done, and of how many.

    The kinds take turns (:data:`igrip.lab.simulation.two_hands.KINDS`). Of a lift, and of one hand
    to each of two objects, both hands have a row. The column ``free_s`` has the time at which the
    target comes free from another hand, where one holds it. What is written does not depend on the
    ``workers``.

    Parameters
    ----------
    catalog : Catalog
        With the objects of :data:`OBJECTS`.
    scenes : int, optional
        Of each participant; by default :data:`SCENES`.

    Raises
    ------
    DatasetError
        If the folder holds something already.
    """
    if participants < 1:
        raise DatasetError("a cohort needs a participant")
    models = {**models_by_id(catalog), BOX_ID: catalog[BOX]}
    source = (
        f"igrip simulate --two-hands --participants {participants} --seed {seed} "
        f"--profile {parameters.profile}; parameters {checksum(parameters)}"
    )
    details: dict[str, Any] = {
        "objects": list(OBJECTS), "simulated": parameters.model_dump(mode="json")
    }  # fmt: skip
    name = f"simulated {parameters.profile}, two hands"
    work = [(p, k) for p in range(participants) for k in range(scenes or SCENES)]
    with DatasetWriter(path, name, "CC0-1.0", source, **details) as writer:
        record = partial(record_scene, parameters, seed, models)
        for done, recordings in enumerate(workers.map(record, work), 1):
            for row, messages in recordings:
                writer.add(row, messages)
            yield done, len(work)
        names = dict.fromkeys(f"p{p + 1:02d}" for p in range(participants))
        writer.close({name: {"profile": parameters.profile} for name in names})


def record_scene(
    parameters: CohortParameters, seed: int, models: Mapping[str, ObjectModel],
    scene: tuple[int, int],
) -> Recordings:  # fmt: skip
    """Return rows and messages of a scene, given participant and number (both from 0)."""
    person, number = scene
    habits = draw_habits(parameters.person, np.random.default_rng([seed, person, 4]))
    random = np.random.default_rng([seed, person, 5, number])
    true = draw_scene(KINDS[number % len(KINDS)], models, parameters, habits, random)
    recordings: Recordings = []
    for side in SIDES:
        camera_at = place_camera(parameters.camera, side, random)
        messages = observe_scene(
            true.times, true.palms, true.table, camera_at, parameters.camera, random, true.moving
        )
        for k, reach in enumerate(true.reaches, 1):
            free = true.free_at(reach.hand, reach.target)
            row = Trial(
                recording=f"p{person + 1:02d}_s{number + 1:03d}_{k}_{side}",
                participant=f"p{person + 1:02d}", trial=str(number + 1), camera=f"camera_{side}",
                camera_side=side, hand=reach.hand, target=reach.target, movement=true.kind,
                onset_s=round(reach.onset, 4), end_s=round(reach.end, 4), performed="yes",
                extra={"free_s": "" if free is None else f"{free:.4f}"},
            )  # fmt: skip
            recordings.append((row, messages))
    return recordings
