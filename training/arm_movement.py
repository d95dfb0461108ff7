"""How an arm moves, in the second generator of reaches (``training/arms.py``).

The shoulder's spherical coordinates of the palm (length of the arm, azimuth, elevation) move, each
with its own time course from the family of regularised incomplete beta functions, so that paths
curve as an arm's do; submovements may stop between; a device may lag behind as a mass with a damper
does (an exoskeleton).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import betainc

Array = NDArray[np.float64]
STEP = 1.0 / 120.0  # s, of the simulated movement
IMPAIRED = 0.45  # share of the people


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
    gap = random.uniform(-0.3, 0.35) if arm.impaired else random.uniform(-0.35, 0.0)
    sizes = np.diff(ends, prepend=0.0)
    lasting = duration * (0.9 * np.sqrt(sizes) if count > 1 else np.ones(1))
    begins = np.concatenate(
        [[0.0], np.cumsum(lasting * (1.0 + gap * random.uniform(0.5, 1.0, count)))]
    )
    offsets = random.normal(0.0, 0.04, (count, 3)) * lasting[:, None]
    stop = float((begins[:-1, None] + offsets + lasting[:, None]).max())  # the last one ends, too
    times = np.arange(max(3, math.ceil(stop / STEP) + 2)) * STEP
    progress = np.zeros((len(times), 3))
    for k, (size, begin, lasts) in enumerate(zip(sizes, begins, lasting, strict=False)):
        early, late = random.uniform(2.2, 4.5), random.uniform(2.2, 5.0)
        wander = random.normal(0.0, 0.15 if arm.impaired else 0.06, 3) * (k < count - 1)
        for axis in range(3):
            part = np.clip((times - begin - offsets[k, axis]) / lasts, 0.0, 1.0)
            progress[:, axis] += size * betainc(early, late, part)
        part = np.clip((times - begin) / lasts, 0.0, 1.0)
        progress += size * np.sin(np.pi * part)[:, None] ** 2 * wander
    return progress


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
