"""Simulated reaches for training: people, tables, sensors and rates drawn from wide ranges.

Wide, so that what is learned is reaching and not one simulator's settings; the frozen cohort that
judges (``lab.simulation.parameters``) is one point among them, its seeds and objects are none.
"""

from __future__ import annotations

import math

import numpy as np

from igrip.lab.simulation.cohort import SIDES, TrialTask, perform, rest_points
from igrip.lab.simulation.minimum_jerk import reach as move
from igrip.lab.simulation.movement import Habits, draw_habits
from igrip.lab.simulation.no_reach import KINDS, draw_no_reach
from igrip.lab.simulation.parameters import (
    CameraParameters,
    CohortParameters,
    PersonParameters,
    ProtocolParameters,
)
from igrip.lab.simulation.sensors import observe_scene, place_camera
from igrip.lab.simulation.table import set_table
from training.moments import THINGS, Recording, catalog

TRIALS = 10  # of each person
COUNTS = (2, 2, 2, 3, 4, 4, 5, 6, 8, 10, 15, 30)  # objects on the table
IMPAIRED = 1 / 3  # of the people (guess): all that is worse than usual in them is worse together
NO_REACH = 1.5  # weight of hands that reach for nothing (guess)
RATES = (15.0, 20.0, 30.0, 30.0, 30.0, 45.0, 60.0, 90.0, 120.0)


def draw_world(random: np.random.Generator) -> CohortParameters:
    """Draw one person with their way of moving, their table and their camera."""

    def between(low: float, high: float) -> float:
        return float(random.uniform(low, high))

    protocol = ProtocolParameters(
        repetitions=1, rate=float(random.choice(RATES)), rest=between(0, 1.6),
        rest_spread=between(0, 0.8), hold=between(0.3, 1.2), table_width=between(0.4, 1.0),
        table_near=between(0.18, 0.35), table_far=between(0.42, 0.75),
        separation=between(0.11, 0.2), rest_aside=between(0.02, 0.35),
        rest_height=between(0.01, 0.2), palm_to_body=between(0.0, 0.12),
        palm_to_top=between(0.0, 0.12), simulated_short=between(0.0, 0.02),
    )  # fmt: skip
    impaired = random.random() < IMPAIRED

    def worse(low: float, high: float) -> float:
        """Draw from the range of the healthy, or from half of it to half beyond it."""
        return between(0.5 * high, 1.5 * high) if impaired else between(low, high)

    duration = math.exp(worse(math.log(0.6), math.log(2.2)))
    person = PersonParameters(
        duration=duration, duration_between=between(0.06, 0.2) * duration,
        duration_within=between(0.06, 0.15) * duration,
        peak_time=between(0.34, 0.52), lift=between(0, 0.12), curvature=worse(-0.05, 0.2),
        curvature_within=worse(0.01, 0.1), aim_error=worse(0, 0.06),
        end_error=worse(0.003, 0.015), submovements=worse(0, 2.5), undershoot=worse(0, 0.35),
        tremor=worse(0.0002, 0.0015), sway=worse(0.001, 0.004), hesitation=worse(0, 0.1),
        change_of_mind=between(0, 0.08), change_at=between(0.25, 0.45),
    )  # fmt: skip
    camera = CameraParameters(
        aside=between(0.1, 0.7), behind=between(-0.2, 0.4), height=between(0.35, 0.9),
        disparity_noise=between(0.05, 0.9), lateral_noise=between(0.0003, 0.003),
        correlation=between(0, 0.8), outliers=between(0, 0.006),
        outlier_size=between(0.03, 0.1), lost=between(0, 0.03), lost_for=between(1.5, 5),
        moving_lost=between(0, 4), swapped=between(0, 0.003), duplicated=between(0, 0.003),
        object_latency=between(0, 0.15), object_rate=between(8, 30), object_bias=between(0, 0.008),
        object_bias_turn=between(0, 0.08), object_jitter=between(0, 0.003),
        object_jitter_turn=between(0, 0.03), flips=between(0, 0.02), object_lost=between(0, 0.03),
        object_lost_for=between(2, 8), never_found=between(0, 0.04), occluded=between(0, 1),
    )  # fmt: skip
    return CohortParameters(protocol=protocol, person=person, camera=camera)


def simulate_person(seed: int, number: int) -> list[Recording]:
    """Return the recordings of one drawn person."""
    random = np.random.default_rng([seed, number])
    world = draw_world(random)
    habits = draw_habits(world.person, random)
    return [_one(f"s{number}", world, habits, random) for _ in range(TRIALS)]


def _one(
    person: str, world: CohortParameters, habits: Habits, random: np.random.Generator
) -> Recording:
    count = int(random.choice(COUNTS))
    names = random.choice(len(THINGS), count, replace=count > len(THINGS))
    models = {f"o{k}": catalog()[THINGS[name]] for k, name in enumerate(names)}
    protocol = world.protocol
    room = protocol.table_width * (protocol.table_far - protocol.table_near)
    apart = min(protocol.separation, 0.5 * math.sqrt(room / count))  # or they find no place
    world = world.model_copy(update={"protocol": protocol.model_copy(update={"separation": apart})})
    camera_at = place_camera(world.camera, SIDES[int(random.integers(2))], random)
    kind = str(random.choice(["reach"] * 12 + ["absent"] * 3 + ["none"] * 6))
    if kind == "none":
        kind = KINDS[int(random.integers(len(KINDS)))]
        table = set_table(models, world.protocol, random)
        scene = draw_no_reach(kind, table, world, rest_points(world.protocol), 8.0, random)
        messages = observe_scene(
            scene.times, scene.palms, table, camera_at, world.camera, random, scene.moving
        )
        return Recording(
            person,
            kind,
            messages,
            scene.hand,
            None,
            math.inf,
            math.inf,
            math.inf,
            protocol.rate,
            weight=NO_REACH,
        )
    hand, target = SIDES[int(random.integers(2))], f"o{int(random.integers(count))}"
    grip = ("palmar", "pinch")[int(random.integers(2))]
    style = ("executed", "simulated")[int(random.integers(2))]
    done = perform(TrialTask(hand, target, grip, style), world, habits, models, random)
    times, palms, back = done.times, dict(done.palms), math.inf
    if random.random() < 0.35:  # the hand goes home again: no reach
        lasts = float(random.uniform(0.7, 1.3))
        more = np.arange(1, int((lasts + 0.3) * protocol.rate) + 1) / protocol.rate
        home = rest_points(world.protocol)[hand] + random.normal(0.0, 0.05, 3) * [1, 1, 0.3]
        lift = float(random.uniform(0.0, 0.08))
        for side in SIDES:
            last = palms[side][-1]
            goes = (
                move(last, home, lift, more / lasts)
                if side == hand
                else np.tile(last, (len(more), 1))
            )
            palms[side] = np.concatenate([palms[side], goes])
        back = float(times[-1]) + 0.02
        times = np.concatenate([times, times[-1] + more])
    messages = observe_scene(times, palms, done.table, camera_at, world.camera, random)
    recording = Recording(
        person, kind, messages, hand, target, *done.bounds, back, protocol.rate, grip=grip
    )
    if kind == "absent":
        return recording.with_absent_target()
    if random.random() < 0.1:
        return recording.without([id for id in models if id != target])
    return recording
