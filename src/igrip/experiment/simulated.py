"""Simulated participants and cameras, so that a study can be tried with nobody there."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from igrip.experiment.live_predictions import LivePredictions
from igrip.experiment.plan import PlannedTrial
from igrip.experiment.study import Study, StudyError
from igrip.io.mcap.writer import McapWriter
from igrip.lab.simulation.cohort import TrialTask, perform_at
from igrip.lab.simulation.movement import draw_habits
from igrip.lab.simulation.parameters import cohort_parameters
from igrip.lab.simulation.sensors import observe_scene, place_camera
from igrip.lab.simulation.table import Table, stand_at
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

KNOWN_LEVELS = {"grip": ("palmar", "pinch"), "movement": ("executed", "simulated")}


class SimulatedRecorder:
    """Records a simulated participant with simulated cameras, as fast as the machine can.

    Parameters
    ----------
    study : Study
        Gives objects, places and cameras.
    catalog : Catalog
        With the models of the study.
    participant : str
        Fixes, with the study's seed, who they are and what they do.
    profile : str
        Of the simulated person.

    Raises
    ------
    StudyError
        If a level of a factor is not one that simulated people know.
    """

    def __init__(
        self, study: Study, catalog: Catalog, participant: str, profile: str = "healthy"
    ) -> None:
        self._study, self._parameters = study, cohort_parameters(profile)
        self._models = {id: catalog[one.model] for id, one in study.objects.items()}
        self._seed = [study.seed, zlib.crc32(participant.encode())]
        random = np.random.default_rng([*self._seed, 0])
        self._habits = draw_habits(self._parameters.person, random)
        self._cameras = {
            name: place_camera(
                self._parameters.camera, name if name in ("left", "right") else "right", random
            )
            for name in study.cameras
        }
        for factor, known in KNOWN_LEVELS.items():
            for level in study.factors.get(factor, ()):
                if level not in known:
                    raise StudyError(
                        f"--simulate: simulated people know the {factor}s {', '.join(known)}; "
                        f"not {level!r:.40}"
                    )
        self._predictions = LivePredictions(study, catalog)
        self._writers: dict[str, McapWriter] = {}
        self._messages: dict[str, list[Observation]] = {}

    def seen(self) -> Mapping[str, bool]:
        """Return that both hands and all objects are seen."""
        return dict.fromkeys(("left hand", "right hand", *self._models), True)

    def picture(self, camera: str) -> bytes | None:
        """Return None: simulated cameras measure, but have no pictures."""
        return None

    def start(self, trial: PlannedTrial, attempt: int, files: Mapping[str, Path]) -> None:
        """Let the person do the trial, and open the files."""
        random = np.random.default_rng([*self._seed, 1, trial.number, attempt])
        task = TrialTask(
            trial.levels["hand"], trial.levels["target"], trial.levels.get("grip", "palmar"),
            trial.levels.get("movement", "executed"),
        )  # fmt: skip
        table = self._table(trial, random)
        done = perform_at(task, table, self._parameters, self._habits, random)
        for k, (camera, path) in enumerate(files.items()):
            noise = np.random.default_rng([*self._seed, 2, trial.number, attempt, k])
            self._messages[camera] = observe_scene(
                done.times, done.palms, done.table, self._cameras[camera],
                self._parameters.camera, noise,
            )  # fmt: skip
            self._writers[camera] = McapWriter(path)

    def _table(self, trial: PlannedTrial, random: np.random.Generator) -> Table:
        """Return the objects at the places of the trial's layout."""
        yaws = {id: float(random.uniform(-np.pi, np.pi)) for id in self._models}
        spots = {id: np.array(self._study.layouts.places[trial.layout[id]]) for id in yaws}
        places = {id: stand_at(model, spots[id], yaws[id]) for id, model in self._models.items()}
        return Table(self._models, places, yaws)

    def mark(self, name: str, **data: Any) -> None:
        """Write an event into the files."""
        for writer in self._writers.values():
            writer.write_event(0.0, name, **data)

    def failure(self) -> str | None:
        """Return that nothing went wrong."""
        return None

    def stop(self) -> None:
        """Write all messages and close the files."""
        for camera, writer in self._writers.items():
            self._predictions.begin_anew()
            with writer:
                for message in self._messages[camera]:
                    writer.write(message)
                    for intention in self._predictions.of(message):
                        writer.write(intention)
        self._writers = {}

    def close(self) -> None:
        """Close what is open."""
        for writer in self._writers.values():
            writer.close()
