"""A simulated person who reaches in turn for the four objects of the paper, for the demo."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from igrip.lab.simulation.minimum_jerk import Array, reach
from igrip.lab.simulation.table import Table, models_by_id, stand_at
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.settings import Settings, quantity


class DemoConfig(Settings):
    """The person, the table and the sensors of the demo. All sizes are guesses."""

    rate: float = quantity(30.0, "Hz", "measurements of the hands", "paper: 30 FPS", gt=0)
    object_rate: float = quantity(12.0, "Hz", "measurements of objects", "CosyPose: 10-15 Hz", gt=0)
    object_latency: float = quantity(0.08, "s", "age of an object's pose on arrival", ge=0)
    hand_noise: float = quantity(0.003, "m", "sd of the hands' positions", ge=0)
    object_noise: float = quantity(0.001, "m", "sd of the objects' positions", ge=0)
    rest: float = quantity(0.6, "s", "rest before a reach", ge=0)
    movement: float = quantity(1.19, "s", "duration of a reach", "paper: 0.52 s + 0.67 s", gt=0)
    hold: float = quantity(0.6, "s", "hold at the object", ge=0)
    back: float = quantity(0.9, "s", "duration of the way back", gt=0)
    lift: float = quantity(0.06, "m", "height of the path over the straight line", ge=0)
    palm_to_body: float = quantity(0.06, "m", "palm to surface in a palmar grasp", ge=0)
    palm_to_top: float = quantity(0.06, "m", "palm over the top in a pinch", ge=0)


@dataclass(frozen=True)
class DemoTask:
    """One reach: hand, target and grip, and its times on the clock of the demo [s]."""

    hand: str
    target: str
    grip: str
    begin: float
    onset: float
    end: float
    finish: float


@dataclass(frozen=True)
class Moment:
    """One message of the demo, and the task it belongs to."""

    observation: Observation
    task: DemoTask


class DemoPerson:
    """A person at a table with the paper's four objects; the same for the same seed.

    ``table`` is where the objects stand, ``rest`` where each palm rests, (3,) [m].
    """

    def __init__(self, catalog: Catalog, seed: int = 0, config: DemoConfig | None = None) -> None:
        self.config = config or DemoConfig()
        self._seed = seed
        random = np.random.default_rng([seed, 0])
        models = models_by_id(catalog)
        places, yaws = {}, {}
        for slot, id in zip(random.permutation(len(models)), models, strict=True):
            x = -0.33 + 0.22 * slot + random.uniform(-0.03, 0.03)
            spot = np.array([x, 0.42 + random.uniform(-0.08, 0.08)])
            yaws[id] = float(random.uniform(-math.pi, math.pi))
            places[id] = stand_at(models[id], spot, yaws[id])
        self.table = Table(models, places, yaws)
        self.rest = {"left": np.array([-0.22, 0.0, 0.04]), "right": np.array([0.22, 0.0, 0.04])}

    def tasks(self) -> Iterator[DemoTask]:
        """Yield tasks without end: rounds of every object × hand × grip, shuffled."""
        config = self.config
        random = np.random.default_rng([self._seed, 1])
        begin = 0.0
        combinations = list(product(self.table.models, self.rest, ("palmar", "pinch")))
        while True:
            for k in random.permutation(len(combinations)):
                target, hand, grip = combinations[k]
                onset = begin + config.rest
                end = onset + config.movement
                finish = end + config.hold + config.back
                yield DemoTask(hand, target, grip, begin, onset, end, finish)
                begin = finish

    @property
    def round(self) -> int:
        """Number of tasks in one round."""
        return len(self.table.models) * len(self.rest) * 2

    def hands(self, task: DemoTask, t: float) -> dict[str, Array]:
        """Return where both palms truly are at a time of a task [m]."""
        config = self.config
        hands = dict(self.rest)
        home = self.rest[task.hand]
        goal = self.table.grasp_point(task.target, task.grip, home, config)
        if t <= task.end + config.hold:
            part = (t - task.onset) / config.movement
        else:
            part = 1.0 - (t - task.end - config.hold) / config.back
        hands[task.hand] = reach(home, goal, config.lift, np.array([part]))[0]
        return hands

    def __iter__(self) -> Iterator[Moment]:
        config = self.config
        random = np.random.default_rng([self._seed, 2])
        frame, next_pose = 0, 0.0
        for task in self.tasks():
            while (t := frame / config.rate) < task.finish:
                hands = {
                    id: {"position": point + random.normal(0.0, config.hand_noise, 3)}
                    for id, point in self.hands(task, t).items()
                }
                objects = {}
                if t >= next_pose:
                    next_pose += 1.0 / config.object_rate
                    objects = {id: self._pose(id, t, random) for id in self.table.models}
                yield Moment(Observation(t=t, hands=hands, objects=objects), task)
                frame += 1

    def _pose(self, id: str, t: float, random: np.random.Generator) -> dict[str, object]:
        half = 0.5 * self.table.yaws[id]
        noise = random.normal(0.0, self.config.object_noise, 3)
        return {
            "model": self.table.models[id].name,
            "t": max(0.0, t - self.config.object_latency),
            "position": self.table.places[id] + noise,
            "orientation": [0.0, 0.0, math.sin(half), math.cos(half)],
        }
