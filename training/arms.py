"""A second generator of reaches, independent of :mod:`igrip.lab.simulation`.

The simulator moves the palm in space by sums of minimum-jerk submovements; here an arm moves
(``training/arm_movement.py``). Movements are planar or spatial, start anywhere, follow one another
without rest, and places stand on tables, walls, lines and circles. What both generators agree on is
reaching, not one of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose
from igrip.observation import Observation
from training.arm_movement import STEP, Arm, carry, draw_arm, move
from training.moments import SHAPES, Recording, catalog

Array = NDArray[np.float64]

TRIALS = 10  # of each person
RATES = (15.0, 20.0, 30.0, 30.0, 30.0, 60.0, 120.0)  # Hz, of the sensor
NOISES = (0.0, 0.0005, 0.001, 0.002, 0.004, 0.004, 0.006)  # m, of the sensor, each axis
COUNTS = (1, 2, 2, 3, 4, 4, 5, 6, 6, 8, 10, 12)  # of objects
LAYOUTS = ("table", "table", "plane", "wall", "line", "circle", "space")
MODES = ("reach", "reach", "reach", "reach", "chain", "none")
NO_REACH = 0.5  # weight of recordings in which nothing that is there is reached for
CLEARANCE = 0.12  # m, that a movement towards none of the objects keeps from each of them


def draw_places(kind: str, count: int, random: np.random.Generator) -> Array:
    """Draw where objects stand, shape (n, 3) [m]."""
    apart = random.uniform(0.09, 0.2)
    towards = np.array([random.normal(0.0, 0.15), 1.0, 0.0])  # of a line
    radius = random.uniform(0.12, 0.3)  # of a circle
    places: list[Array] = []
    while len(places) < count:
        apart *= 0.999  # until there is room
        if kind == "table":
            place = random.uniform([-0.4, 0.18, 0.0], [0.4, 0.65, 0.12])
        elif kind == "plane":
            place = random.uniform([-0.25, 0.15, 0.0], [0.25, 0.5, 0.0])
        elif kind == "wall":
            place = random.uniform([-0.5, 0.48, -0.4], [0.5, 0.52, 0.5])
        elif kind == "line":
            place = np.array([0.0, 0.2, 0.0]) + towards * random.uniform(0.0, 0.5)
        elif kind == "circle":
            angle = random.uniform(0.0, 2.0 * np.pi)
            place = np.array([radius * math.sin(angle), 0.35 + radius * math.cos(angle), 0.0])
        else:
            place = random.uniform([-0.4, 0.1, -0.2], [0.4, 0.7, 0.5])
        if all(np.linalg.norm(place - other) > apart for other in places):
            places.append(place)
    return np.array(places)


def simulate_arm(seed: int, number: int) -> list[Recording]:
    """Return the recordings of one drawn person."""
    random = np.random.default_rng([seed, number])
    arm = draw_arm(random)
    layout = "plane" if arm.planar else str(random.choice(LAYOUTS))
    rate, noise = float(random.choice(RATES)), float(random.choice(NOISES))
    trials = [_trial(arm, layout, random) for _ in range(TRIALS)]
    return [record_trial(f"a{number}", t, rate, noise, random) for t in trials if t is not None]


@dataclass(frozen=True)
class Trial:
    """One simulated movement.

    Attributes
    ----------
    mode : str
        ``reach``, ``chain`` (after another movement) or ``none``.
    path : (n, 3)
        Of the palm, at steps of :data:`STEP` [m].
    poses : mapping of str to ObjectPose
        Of the objects.
    target : str or None
        What is reached for.
    onset, end, back : float
        Of the reach, and when the palm leaves the object again [s]; infinite where there is none.
    """

    mode: str
    path: Array
    poses: dict[str, ObjectPose]
    target: str | None
    onset: float = math.inf
    end: float = math.inf
    back: float = math.inf


def _trial(arm: Arm, layout: str, random: np.random.Generator) -> Trial | None:
    """Simulate one trial; None where everything is too near to the hand to be reached for."""
    places = draw_places(layout, int(random.choice(COUNTS)), random)
    poses, grasps = _stand(places, random)
    home = random.uniform([-0.3, -0.1, 0.0], [0.3, 0.15, 0.15]) * arm.plane
    start = home
    if random.random() < 0.35:  # at another object
        start = places[random.integers(len(places))] + random.normal(0.0, 0.03, 3) * arm.plane
    elif random.random() < 0.4:  # anywhere
        start = random.uniform(places.min(axis=0) - 0.15, places.max(axis=0) + 0.15) * arm.plane
    rest = float(random.choice([0.0, 0.3, 0.8, 1.5])) * random.uniform(0.5, 1.0)
    parts = [hold(start, rest)]
    mode = str(random.choice(MODES))
    if mode == "none":
        parts += _wander(arm, start, places, random)
        return Trial(mode, executed(arm, parts, random), poses, None)
    if mode == "chain":
        via = random.uniform(places.min(axis=0) - 0.2, places.max(axis=0) + 0.2) * arm.plane
        parts.append(move(arm, start, via, random)[1:])
        start = parts[-1][-1]
        parts.append(hold(start, float(random.choice([0.0, 0.0, 0.2, 0.5]))))
    far = np.flatnonzero(np.linalg.norm(places - start, axis=1) > 0.1)
    if not len(far):
        return None
    chosen = int(random.choice(far))
    if len(far) > 1 and random.random() < 0.06:  # a change of mind
        other = int(random.choice(far[far != chosen]))
        first = move(arm, start, _aim(arm, places, grasps, other, start, random), random)
        parts.append(first[1 : max(3, int(len(first) * random.uniform(0.2, 0.45)))])
        start = parts[-1][-1]
    begin = sum(map(len, parts))
    parts.append(move(arm, start, _aim(arm, places, grasps, chosen, start, random), random)[1:])
    stop = sum(map(len, parts))
    parts.append(hold(parts[-1][-1], random.uniform(0.2, 0.9)))
    back = math.inf
    if random.random() < 0.3:
        back = sum(map(len, parts)) * STEP + 0.02
        near_home = home + random.normal(0.0, 0.05, 3) * arm.plane
        parts.append(move(arm, parts[-1][-1], near_home, random)[1:])
    path = executed(arm, parts, random)
    bounds = find_bounds(path, begin, min(stop + int(2.0 * arm.lag / STEP), len(path) - 1))
    return None if bounds is None else Trial(mode, path, poses, f"o{chosen}", *bounds, back)


def _stand(
    places: Array, random: np.random.Generator
) -> tuple[dict[str, ObjectPose], list[tuple[Array, float]]]:
    """Return poses with the middle of each object's cylinder at its place, and axes to grasp."""
    poses, grasps = {}, []
    lies = random.random() < 0.3
    for k, place in enumerate(places):
        model = catalog()[SHAPES[int(random.integers(len(SHAPES)))]]
        turn = Rotation.random(rng=random) if lies else Rotation.identity()
        x, y, z = (place - turn.apply(model.origin)).tolist()
        qx, qy, qz, qw = turn.as_quat().tolist()
        poses[f"o{k}"] = ObjectPose(
            model=model.name, position=(x, y, z), orientation=(qx, qy, qz, qw), static=True
        )
        grasps.append((turn.apply(model.axis), 0.5 * model.length))
    return poses, grasps


def _aim(
    arm: Arm, places: Array, grasps: list[tuple[Array, float]], chosen: int, start: Array,
    random: np.random.Generator,
) -> Array:  # fmt: skip
    """Return where the palm stops: beside a point of the object's axis."""
    axis, half_length = grasps[chosen]
    along = 0.0 if arm.planar else random.uniform(-0.7, 0.7) * half_length
    back = start - places[chosen]
    aside = random.uniform(0.0, 0.05) * back / np.linalg.norm(back)
    aim: Array = places[chosen] + along * axis + aside + random.normal(0.0, 0.012, 3)
    return aim * arm.plane


def _wander(arm: Arm, start: Array, places: Array, random: np.random.Generator) -> list[Array]:
    """Return movements towards none of the objects."""
    parts = []
    for _ in range(int(random.integers(2, 7))):
        for _ in range(50):
            goal = start + random.normal(0.0, 0.15, 3) * arm.plane
            if np.linalg.norm(places - goal, axis=1).min() > CLEARANCE:
                break
        parts.append(move(arm, start, goal, random)[1:])
        start = parts[-1][-1]
        if random.random() < 0.5:
            parts.append(hold(start, random.uniform(0.05, 0.8)))
    return parts


def hold(place: Array, seconds: float) -> Array:
    """Return the path of a palm that rests, shape (n, 3)."""
    return np.repeat(place[None], int(seconds / STEP) + 1, axis=0)


def executed(arm: Arm, parts: list[Array], random: np.random.Generator) -> Array:
    """Return the path with a device's lag, noise that grows with the speed, and tremor."""
    path = carry(arm, np.concatenate(parts))
    speed = np.linalg.norm(np.diff(path, axis=0, prepend=path[:1]), axis=1) / STEP
    drift = lfilter([1.0], [1.0, -math.exp(-STEP / 0.25)], random.normal(size=path.shape), axis=0)
    drift /= drift.std() + 1e-9
    size = 0.0008 + (0.008 if arm.impaired else 0.004) * np.minimum(speed, 1.0)
    phase = random.uniform(0.0, 2.0 * np.pi, 3)
    times = np.arange(len(path)) * STEP
    shake = arm.tremor * np.sin(2.0 * np.pi * arm.tremor_rate * times[:, None] + phase)
    moved: Array = path + (drift * size[:, None] + shake) * arm.plane
    return moved


def find_bounds(path: Array, begin: int, stop: int) -> tuple[float, float] | None:
    """Return onset and end by 10 % of the peak speed between two samples [s]; None: no movement."""
    if stop - begin < 5:
        return None
    steps = np.linalg.norm(np.diff(path[begin : stop + 1], axis=0), axis=1)
    speed = np.convolve(steps, np.ones(9) / 9.0, mode="same")
    peak = int(speed.argmax())
    slow = np.flatnonzero(speed[: peak + 1] < 0.1 * speed[peak])
    fast = np.flatnonzero(speed[peak:] > 0.1 * speed[peak])
    onset = (begin + (int(slow[-1]) if len(slow) else 0)) * STEP
    end = (begin + peak + int(fast[-1]) + 1) * STEP
    return (onset, end) if end - onset > 0.15 else None


def record_trial(
    person: str, trial: Trial, rate: float, noise: float, random: np.random.Generator
) -> Recording:
    """Return a trial as a sensor sees it: sampled, with noise that may be correlated, with gaps."""
    times = np.arange(len(trial.path)) * STEP
    samples = np.arange(int(times[-1] * rate) + 1) / rate
    palms = np.stack([np.interp(samples, times, trial.path[:, axis]) for axis in range(3)], axis=1)
    white = random.normal(size=palms.shape)
    memory = float(random.choice([0.0, 0.0, 0.5, 0.8]))
    coloured = lfilter([math.sqrt(1.0 - memory**2)], [1.0, -memory], white, axis=0)
    palms += noise * coloured
    lost = random.random(len(palms)) < (random.uniform(0.0, 0.08) if random.random() < 0.3 else 0.0)
    messages = [
        Observation(
            t=float(t),
            hands={} if gone else {"right": {"position": palm}},
            objects=trial.poses if k == 0 else {},
        )
        for k, (t, palm, gone) in enumerate(zip(samples, palms.tolist(), lost, strict=True))
    ]
    recording = Recording(
        person, "reach" if trial.target else "none", messages, "right", trial.target, trial.onset,
        trial.end, trial.back, rate, weight=1.0 if trial.target else NO_REACH,
    )  # fmt: skip
    if trial.target and len(trial.poses) > 1 and random.random() < 0.1:
        absent = recording.with_absent_target()
        return replace(absent, weight=0.3 * NO_REACH)
    return recording
