"""Grasps by the arms of the second generator: beside the body of an object, or at its end.

Independent of the grasps of :mod:`igrip.lab.simulation`, where a palmar grip always ends at
mid-height and a pinch above the middle of the top: here palms end anywhere in the zone of their
grip (the paper's Figure 2), on any side, and objects may lie. Nothing that ships is learned from
them; ``training/grip_check.py`` judges by them.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose
from igrip.objects.model import ObjectModel
from training.arm_movement import STEP, Arm, draw_arm, move
from training.arms import (
    COUNTS,
    NOISES,
    RATES,
    Trial,
    draw_places,
    executed,
    find_bounds,
    hold,
    record_trial,
)
from training.moments import THINGS, Recording, catalog

Array = NDArray[np.float64]
TRIALS = 6  # of each person
LAYOUTS = ("table", "table", "table", "line", "circle", "space")
LIES = 0.2  # share of the scenes in which objects lie
BODY = 0.65  # half-lengths: palmar grips end within ± this
BRIM = (0.92, 1.05)  # half-lengths: pinches from the side end between these
GAP = 0.06  # m, from the surface to the palm at most
AIM = 0.006  # m, spread of the aim


def simulate_grasps(seed: int, number: int) -> list[Recording]:
    """Return the recordings of one drawn person: reaches with a known grip."""
    random = np.random.default_rng([seed, number, 2])
    arm = replace(draw_arm(random), planar=False)
    rate, noise = float(random.choice(RATES)), float(random.choice(NOISES))
    recordings = []
    for _ in range(TRIALS):
        grip = ("palmar", "pinch")[int(random.integers(2))]
        trial = _trial(arm, grip, random)
        if trial is not None:
            recording = record_trial(f"g{number}", trial, rate, noise, random)
            recordings.append(replace(recording, grip=grip))
    return recordings


def _trial(arm: Arm, grip: str, random: np.random.Generator) -> Trial | None:
    places = draw_places(str(random.choice(LAYOUTS)), int(random.choice(COUNTS)), random)
    lies = random.random() < LIES
    poses, chosen = {}, int(random.integers(len(places)))
    goal = start = random.uniform([-0.35, -0.1, -0.05], [0.35, 0.12, 0.15])
    for k, place in enumerate(places):
        model = catalog()[THINGS[int(random.integers(len(THINGS)))]]
        yaw = Rotation.from_euler("z", random.uniform(-math.pi, math.pi))
        turn = Rotation.random(rng=random) if lies else yaw
        x, y, z = (place - turn.apply(model.origin)).tolist()
        qx, qy, qz, qw = turn.as_quat().tolist()
        poses[f"o{k}"] = ObjectPose(
            model=model.name, position=(x, y, z), orientation=(qx, qy, qz, qw), static=True
        )
        if k == chosen:
            goal = place + _grasp(model, turn.apply(model.axis), start - place, grip, random)
    if np.linalg.norm(goal - start) < 0.12:
        return None
    parts = [hold(start, float(random.choice([0.0, 0.5, 1.2])))]
    begin = len(parts[0])
    parts.append(move(arm, start, goal, random)[1:])
    stop = begin + len(parts[1])
    parts.append(hold(parts[-1][-1], random.uniform(0.3, 0.9)))
    path = executed(arm, parts, random)
    bounds = find_bounds(path, begin, min(stop + int(2.0 * arm.lag / STEP), len(path) - 1))
    return None if bounds is None else Trial("reach", path, poses, f"o{chosen}", *bounds)


def _grasp(
    model: ObjectModel, axis: Array, back: Array, grip: str, random: np.random.Generator
) -> Array:
    """Return where the palm ends, from the middle of an object's cylinder [m], shape (3,).

    ``back`` leads from there to the hand at the start. A pinch takes the end on the hand's side of
    an object that lies, and else the upper one.
    """
    half = 0.5 * model.length
    if abs(axis[2]) > 0.9:
        axis = axis * np.sign(axis[2])
    elif back @ axis < 0.0:
        axis = -axis
    aside = back - (back @ axis) * axis
    aside = Rotation.from_rotvec(axis * random.normal(0.0, 0.5)).apply(aside)
    aside /= np.linalg.norm(aside)
    gap = random.uniform(0.0, GAP)
    if grip == "palmar":
        along, out = random.uniform(-BODY, BODY) * half, model.radius + gap
    elif random.random() < 0.5:  # from the side
        along, out = random.uniform(*BRIM) * half, model.radius + gap
    else:  # from beyond the end
        along, out = half + gap, random.uniform(0.0, 0.5) * model.radius
    along += random.normal(0.0, min(AIM, 0.1 * half))
    place: Array = along * axis + out * aside + random.normal(0.0, AIM) * np.cross(axis, aside)
    return place
