"""A simulated reach as a rendered camera films it: from pixels on, with the truth beside."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import OAK, RenderedScene
from igrip.lab.simulation.cohort import SIDES, PerformedTask, TrialTask, perform
from igrip.lab.simulation.movement import draw_habits
from igrip.lab.simulation.parameters import CohortParameters, cohort_parameters
from igrip.lab.simulation.table import models_by_id, object_ids
from igrip.objects.catalog import PAPER_OBJECTS, Catalog
from igrip.rgbd import Array, Intrinsics, RgbdFrame

MIDDLE = np.array([0.0, 0.30, 0.0])  # of the protocol's table; the rendered world begins there [m]
LOOKS_AT = np.array([0.0, -0.02, 0.06])  # guess [m]
CAMERA = np.array([0.0, 0.60, 0.62])  # across the table from the person, guess [m]
SPREAD = np.array([0.20, 0.05, 0.05])  # of that place between trials, guess [m]

PutHand = Callable[[RgbdFrame, str, Array], RgbdFrame]
"""From a frame without a hand, the side, and the palm in the camera's frame (3,) [m], to the frame
with it."""


@dataclass(frozen=True, eq=False)
class FilmedReach:
    """One trial before a camera."""

    task: TrialTask  # models are the objects' ids
    done: PerformedTask  # in the protocol's world; that of the frames begins at MIDDLE
    scene: RenderedScene  # the table, and where the camera stands
    seed: int  # of the camera's noise

    def frames(self, put_hand: PutHand, begin: float = 0.0) -> Iterator[RgbdFrame]:
        """Render the trial from a time on [s]; ``put_hand`` is called for the hand that reaches."""
        random = np.random.default_rng(self.seed)
        for t, palm in zip(self.done.times.tolist(), self.palms(), strict=True):
            yield put_hand(self.scene.frame(begin + t, random), self.task.hand, palm)

    def palms(self) -> Array:
        """Return where the palm of the hand that reaches is, camera frame, shape (n, 3) [m]."""
        camera_from_world = np.linalg.inv(self.scene.world_from_camera)
        world = self.done.palms[self.task.hand] - MIDDLE
        there: Array = world @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
        return there


def film_reach(
    catalog: Catalog, seed: int, world: CohortParameters | None = None, intrinsics: Intrinsics = OAK
) -> FilmedReach:
    """Let a simulated person do one trial of the paper's protocol, before a camera.

    The catalog must hold the paper's objects. Another seed is another person, table, task and
    camera; ``world`` holds people and protocol, healthy by default.
    """
    random = np.random.default_rng(seed)
    world = world or cohort_parameters("healthy")
    ids = object_ids()
    names = PAPER_OBJECTS
    models = models_by_id(catalog)
    task = TrialTask(
        hand=SIDES[int(random.integers(2))], target=ids[int(random.integers(len(ids)))],
        grip=("palmar", "pinch")[int(random.integers(2))], movement="executed",
    )  # fmt: skip
    done = perform(task, world, draw_habits(world.person, random), models, random)
    objects = {}
    for name, (id, model) in zip(names, models.items(), strict=True):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = done.table.rotation(id), done.table.places[id] - MIDDLE
        objects[name] = PlacedMesh(model, pose)
    camera = look_at(CAMERA + random.normal(0.0, SPREAD), LOOKS_AT)
    scene = RenderedScene(objects, camera, intrinsics)
    named = TrialTask(task.hand, names[ids.index(task.target)], task.grip, task.movement)
    return FilmedReach(named, done, scene, int(random.integers(2**31)))
