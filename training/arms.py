"""A second generator of reaches, independent of :mod:`igrip.lab.simulation`.

The simulator moves the palm in space by sums of minimum-jerk submovements. Here the shoulder's
spherical coordinates of the palm (length of the arm, azimuth, elevation) move, each with its own
time course from the family of regularised incomplete beta functions, so that paths curve as an
arm's do; submovements may stop between; a device may lag behind as a mass with a damper does
(an exoskeleton); movements are planar or spatial, start anywhere, follow one another without rest,
and places stand on tables, walls, lines and circles. What both generators agree on is reaching, not
one of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation
from scipy.special import betainc

from igrip.entities import ObjectPose
from igrip.observation import Observation
from training.moments import SHAPES, Recording, catalog

Array = NDArray[np.float64]

TRIALS = 10  # of each person
STEP = 1.0 / 120.0  # s, of the simulated movement
RATES = (15.0, 20.0, 30.0, 30.0, 30.0, 60.0, 120.0)  # Hz, of the sensor
NOISES = (0.0, 0.0005, 0.001, 0.002, 0.004, 0.004, 0.006)  # m, of the sensor, each axis
COUNTS = (1, 2, 2, 3, 4, 4, 5, 6, 6, 8, 10, 12)  # of objects
LAYOUTS = ("table", "table", "plane", "wall", "line", "circle", "space")
MODES = ("reach", "reach", "reach", "reach", "chain", "none")
IMPAIRED = 0.45  # share of the people
NO_REACH = 0.5  # weight of recordings in which nothing that is there is reached for
CLEARANCE = 0.12  # m, that a movement towards none of the objects keeps from each of them


@dataclass(frozen=True)
class Arm:
    """How one person moves.

    Attributes
    ----------
    impaired : bool
        Slower, in more submovements that may stop between, more curved, with more tremor.
    shoulder : (3,)
        World frame [m].
    bend : float
        0: straight paths; 1: straight in the shoulder's coordinates, curved in space.
    lift : float
        Height gained on the way, in lengths of the reach.
    lag : float
        Time constant of a device that the arm is in; 0: none [s].
    damping : float
        Damping ratio of that device.
    planar : bool
        Whether all happens in the plane z = 0.
    tremor, tremor_rate : float
        Amplitude and frequency [m, Hz].
    """

    impaired: bool
    shoulder: Array
    bend: float
    lift: float
    lag: float
    damping: float
    planar: bool
    tremor: float
    tremor_rate: float

    @property
    def plane(self) -> Array:
        """What keeps a vector in the space of this arm, shape (3,)."""
        return np.array([1.0, 1.0, 0.0 if self.planar else 1.0])


def draw_arm(random: np.random.Generator) -> Arm:
    """Draw a person."""
    impaired = bool(random.random() < IMPAIRED)
    planar = bool(random.random() < 0.25)
    lags = (0.0, 0.0, random.uniform(0.02, 0.15)) if impaired else (0.0, 0.0, 0.0, 0.03)
    return Arm(
        impaired=impaired,
        shoulder=random.uniform([-0.3, -0.35, 0.1], [0.3, 0.0, 0.45]),
        bend=float(random.uniform(0.0, 1.0)),
        lift=0.0 if planar else abs(float(random.normal(0.0, 0.15))),
        lag=float(random.choice(lags)),
        damping=float(random.uniform(0.6, 1.2)),
        planar=planar,
        tremor=float(random.uniform(0.0003, 0.003) if impaired else random.uniform(0.0, 0.0007)),
        tremor_rate=float(random.uniform(3.0, 9.0)),
    )


def move(arm: Arm, start: Array, goal: Array, random: np.random.Generator) -> Array:
    """Return the palm's path from one point to another at steps of :data:`STEP`, shape (n, 3)."""
    distance = float(np.linalg.norm(goal - start))
    duration = math.exp(random.normal(math.log(0.75), 0.22)) * (0.5 + 0.5 * min(distance / 0.35, 2))
    if arm.impaired:
        duration *= random.uniform(1.2, 3.0)
    progress = _progress(arm, duration, random)
    curved = _from_shoulder(
        arm,
        (first := _to_shoulder(arm, start)) + progress * (_to_shoulder(arm, goal) - first),
    )
    path: Array = arm.bend * curved + (1 - arm.bend) * (start + progress * (goal - start))
    done = np.clip(progress.mean(axis=1), 0.0, 1.0)
    path[:, 2] += arm.lift * distance * 4.0 * done * (1.0 - done)
    aside = np.cross(goal - start, [0.0, 0.0, 1.0])
    if (length := np.linalg.norm(aside)) > 1e-6:
        bow = random.normal(0.0, 0.12 if arm.impaired else 0.06) * distance
        path += (bow * np.sin(np.pi * done) ** 2)[:, None] * aside / length
    return path


def _progress(arm: Arm, duration: float, random: np.random.Generator) -> Array:
    """Return the part of the way that each of three coordinates has covered, shape (n, 3)."""
    single = not arm.impaired and random.random() < 0.55
    count = 1 if single else int(random.integers(2, 6 if arm.impaired else 4))
    least = 0.15 if arm.impaired else 0.35
    ends = [*np.sort(random.uniform(least, 0.97, count - 1)), 1.0]
    times = np.arange(max(3, int(1.6 * duration / STEP) + 2)) * STEP
    progress = np.zeros((len(times), 3))
    gap = random.uniform(-0.3, 0.35) if arm.impaired else random.uniform(-0.35, 0.0)
    begin = before = 0.0
    for k, end in enumerate(ends):
        size = end - before
        lasts = duration * (0.9 * math.sqrt(size) if count > 1 else 1.0)
        early, late = random.uniform(2.2, 4.5), random.uniform(2.2, 5.0)
        wander = random.normal(0.0, 0.15 if arm.impaired else 0.06, 3) * (k < count - 1)
        for axis in range(3):
            offset = random.normal(0.0, 0.04) * lasts
            part = np.clip((times - begin - offset) / lasts, 0.0, 1.0)
            progress[:, axis] += size * betainc(early, late, part)
        part = np.clip((times - begin) / lasts, 0.0, 1.0)
        progress += size * np.sin(np.pi * part)[:, None] ** 2 * wander
        begin += lasts * (1.0 + gap * random.uniform(0.5, 1.0))
        before = end
    return progress[: min(len(times), int(begin / STEP) + 3)]


def _to_shoulder(arm: Arm, point: Array) -> Array:
    x, y, z = point - arm.shoulder
    length = math.sqrt(x * x + y * y + z * z)
    return np.array([length, math.atan2(x, y), math.asin(z / max(length, 1e-6))])


def _from_shoulder(arm: Arm, coordinates: Array) -> Array:
    length, azimuth, elevation = coordinates.T
    flat = length * np.cos(elevation)
    points = [flat * np.sin(azimuth), flat * np.cos(azimuth), length * np.sin(elevation)]
    return np.stack(points, axis=1) + arm.shoulder


def carry(arm: Arm, path: Array) -> Array:
    """Return the path of a device that the arm moves: a mass on a spring with a damper."""
    if arm.lag <= 0.0:
        return path
    step, stiffness = 0.25 * STEP, 1.0 / arm.lag**2
    place, velocity = path[0].copy(), np.zeros(3)
    carried = np.empty_like(path)
    for k, goal in enumerate(path):
        for _ in range(4):
            pull = stiffness * (goal - place) - 2.0 * arm.damping / arm.lag * velocity
            velocity += step * pull
            place += step * velocity
        carried[k] = place
    return carried


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
    return [_record(f"a{number}", t, rate, noise, random) for t in trials if t is not None]


@dataclass(frozen=True)
class _Trial:
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


def _trial(arm: Arm, layout: str, random: np.random.Generator) -> _Trial | None:
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
    parts = [_hold(start, rest)]
    mode = str(random.choice(MODES))
    if mode == "none":
        parts += _wander(arm, start, places, random)
        return _Trial(mode, _executed(arm, parts, random), poses, None)
    if mode == "chain":
        via = random.uniform(places.min(axis=0) - 0.2, places.max(axis=0) + 0.2) * arm.plane
        parts.append(move(arm, start, via, random)[1:])
        start = parts[-1][-1]
        parts.append(_hold(start, float(random.choice([0.0, 0.0, 0.2, 0.5]))))
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
    parts.append(_hold(parts[-1][-1], random.uniform(0.2, 0.9)))
    back = math.inf
    if random.random() < 0.3:
        back = sum(map(len, parts)) * STEP + 0.02
        near_home = home + random.normal(0.0, 0.05, 3) * arm.plane
        parts.append(move(arm, parts[-1][-1], near_home, random)[1:])
    path = _executed(arm, parts, random)
    bounds = _bounds(path, begin, min(stop + int(2.0 * arm.lag / STEP), len(path) - 1))
    return None if bounds is None else _Trial(mode, path, poses, f"o{chosen}", *bounds, back)


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
            parts.append(_hold(start, random.uniform(0.05, 0.8)))
    return parts


def _hold(place: Array, seconds: float) -> Array:
    return np.repeat(place[None], int(seconds / STEP) + 1, axis=0)


def _executed(arm: Arm, parts: list[Array], random: np.random.Generator) -> Array:
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


def _bounds(path: Array, begin: int, stop: int) -> tuple[float, float] | None:
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


def _record(
    person: str, trial: _Trial, rate: float, noise: float, random: np.random.Generator
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
