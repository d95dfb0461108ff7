"""What the estimator makes of two hands: the tables of docs/two-hands.md.

python -m benchmarks.measure_two_hands            # passes, handovers, lifts, one hand to each
python -m benchmarks.measure_two_hands --cost     # of one update, beside one without two hands
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

import igrip
from igrip.intention import Intention
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.calibration import ReliabilityBins
from igrip.lab.evaluation.trial_metrics import score_answers
from igrip.lab.simulation.movement import draw_habits
from igrip.lab.simulation.parameters import CohortParameters, cohort_parameters
from igrip.lab.simulation.sensors import observe_scene, place_camera
from igrip.lab.simulation.table import models_by_id
from igrip.lab.simulation.two_hands import BOX, BOX_ID, KINDS, draw_scene
from igrip.lab.simulation.two_hands_scene import Reach, TwoHandsScene
from igrip.observation import Observation

COLUMNS = (
    "kind", "reaches", "trials right", "40 %", "60 %", "85 %", "ECE", "committed", "right",
    "leases on held", "of them", "lease after free",
)  # fmt: skip


class Recorded(NamedTuple):
    """A scene, and what one camera saw of it."""

    scene: TwoHandsScene
    messages: list[Observation]


class Answered(NamedTuple):
    """One reach of a scene, and what became of it."""

    kind: str
    success: bool
    right: Mapping[float, bool]  # at parts of the movement
    stated: list[float]
    correct: list[bool]
    first: str | None  # target of the first lease until the end
    target: str
    held: int  # messages with a lease on what another hand holds
    free: bool | None  # whether a lease on it came after it was free; None: it always was


def parameters(clean: bool) -> CohortParameters:
    """Return those of the cohort; ``clean``: nothing is lost, mislabelled or never found."""
    cohort = cohort_parameters()
    if not clean:
        return cohort
    none = dict.fromkeys(("lost", "swapped", "duplicated", "object_lost", "never_found"), 0.0)
    return cohort.model_copy(update={"camera": cohort.camera.model_copy(update=none)})


def record(kind: str, count: int, seed: int, clean: bool) -> Iterator[Recorded]:
    """Yield so many scenes of a kind, each of another person."""
    cohort = parameters(clean)
    catalog = igrip.load_objects("ycb", BOX)
    models = {**models_by_id(catalog), BOX_ID: catalog[BOX]}
    for k in range(count):
        random = np.random.default_rng([seed, KINDS.index(kind), k])
        scene = draw_scene(kind, models, cohort, draw_habits(cohort.person, random), random)
        camera = place_camera(cohort.camera, ("left", "right")[k % 2], random)
        yield Recorded(scene, observe_scene(
            scene.times, scene.palms, scene.table, camera, cohort.camera, random, scene.moving
        ))  # fmt: skip


def answer(one: Recorded, catalog: igrip.Catalog, config: igrip.Config) -> list[Answered]:
    """Return what the estimator makes of each reach of a scene."""
    estimator, intentions = igrip.Estimator(catalog, config), []
    for message in one.messages:
        intentions += estimator.update(message)
    return [_answer(one.scene, reach, intentions) for reach in one.scene.reaches]


def _answer(scene: TwoHandsScene, reach: Reach, intentions: list[Intention]) -> Answered:
    trial = Trial("", hand=reach.hand, target=reach.target)
    score = score_answers(trial, (reach.onset, reach.end), intentions)
    own = [i for i in intentions if i.hand == reach.hand]
    within = [i for i in own if reach.onset <= i.t <= reach.end]
    leases = [(i.t, i.commitment) for i in own if i.commitment and i.t >= reach.onset - 0.5]
    first = next((lease.target for t, lease in leases if t <= reach.end), None)
    held = [i for i in own if i.commitment and scene.held_before(i.hand, i.commitment.target, i.t)]
    free_at, free = scene.free_at(reach.hand, reach.target), None
    if free_at is not None:
        free = any(lease.target == reach.target and t >= free_at for t, lease in leases)
    named = [(i.probability[i.target], i.target) for i in within if i.probability and i.target]
    return Answered(
        scene.kind, bool(score["success"]),
        {part: bool(score[f"right_at_{part:.0%}"]) for part in (0.4, 0.6, 0.85)},
        [p for p, _ in named], [target == reach.target for _, target in named],
        first, reach.target, len(held), free,
    )  # fmt: skip


def row(kind: str, answered: list[Answered]) -> list[str]:
    """Return the cells of a kind."""

    def share(flags: list[bool]) -> str:
        return f"{100 * np.mean(flags):.1f} %" if flags else "-"

    stated = [p for a in answered for p in a.stated]
    correct = [c for a in answered for c in a.correct]
    committed = [a for a in answered if a.first is not None]
    freed = [a.free for a in answered if a.free is not None]
    return [
        kind, str(len(answered)), share([a.success for a in answered]),
        *(share([a.right[part] for a in answered]) for part in (0.4, 0.6, 0.85)),
        f"{ReliabilityBins.of(stated, correct).calibration_error():.3f}",
        share([a.first is not None for a in answered]),
        share([a.first == a.target for a in committed]),
        str(sum(a.held for a in answered)), share([a.held > 0 for a in answered]), share(freed),
    ]  # fmt: skip


class _Apart(igrip.Estimator):
    """The estimator without what it does about two hands."""

    def __init__(self, catalog: igrip.Catalog, config: igrip.Config) -> None:
        super().__init__(catalog, config)
        self._joint.update = lambda hands, objects, followed: [  # type: ignore[method-assign]
            hand.estimate for hand in hands
        ]
        self._holding.update = lambda *arguments: None  # type: ignore[method-assign]


def cost(kind: str, seed: int, catalog: igrip.Catalog) -> list[str]:
    """Return median times of an update with and without two hands [ms], and their ratio.

    Both take turns, message by message, over the same scenes.
    """
    times: dict[type, list[float]] = {igrip.Estimator: [], _Apart: []}
    for one in record(kind, 6, seed, clean=True):
        estimators = [each(catalog, igrip.Config()) for each in times]
        for number, message in enumerate(one.messages):
            for estimator in estimators[:: 1 if number % 2 else -1]:
                begin = time.perf_counter()
                estimator.update(message)
                times[type(estimator)].append(time.perf_counter() - begin)
    joint, apart = (1000.0 * float(np.median(each)) for each in times.values())
    return [kind, f"{joint:.2f} ms", f"{apart:.2f} ms", f"{joint / apart:.2f}"]


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="scenes of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cost", action="store_true", help="measure the cost of an update")
    parser.add_argument("--clean", action="store_true", help="nothing is lost or mislabelled")
    parser.add_argument("--kinds", nargs="*", default=KINDS, choices=KINDS)
    arguments = parser.parse_args()
    catalog, config = igrip.load_objects("ycb", BOX), igrip.Config()
    if arguments.cost:
        print("| kind | update | without two hands | ratio |\n| --- | --- | --- | --- |")
        for kind in arguments.kinds:
            print(f"| {' | '.join(cost(kind, arguments.seed, catalog))} |", flush=True)
        return
    print(f"| {' | '.join(COLUMNS)} |\n|{' --- |' * len(COLUMNS)}")
    for kind in arguments.kinds:
        answered = [
            a for one in record(kind, arguments.count, arguments.seed, arguments.clean)
            for a in answer(one, catalog, config)
        ]  # fmt: skip
        print(f"| {' | '.join(row(kind, answered))} |", flush=True)


if __name__ == "__main__":
    main()
