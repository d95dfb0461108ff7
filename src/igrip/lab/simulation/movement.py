"""How a simulated person moves a hand: one reach as a sum of minimum-jerk submovements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from igrip.lab.simulation.minimum_jerk import Array, progress
from igrip.lab.simulation.parameters import PersonParameters


@dataclass(frozen=True)
class Habits:
    """How one participant moves, drawn once: the means of their trials."""

    duration: float
    peak_time: float
    lift: float
    curvature: float


def draw_habits(person: PersonParameters, random: np.random.Generator) -> Habits:
    """Draw a participant."""
    return Habits(
        duration=max(0.5, random.normal(person.duration, person.duration_between)),
        peak_time=float(
            np.clip(random.normal(person.peak_time, person.peak_time_between), 0.3, 0.6)
        ),
        lift=random.normal(person.lift, person.lift_between),
        curvature=person.curvature,
    )


@dataclass(frozen=True)
class Submovement:
    """A displacement that is superposed on what else the hand does."""

    begin: float  # [s]
    duration: float  # [s]
    displacement: Array  # in all, (3,) [m]
    peak_time: float = 0.5  # part of the duration at which it is half done

    def done(self, t: Array) -> Array:
        """Return which part of the way is done at times [s]."""
        part = np.clip((t - self.begin) / self.duration, 0.0, 1.0)
        # a smooth change of pace that puts the half of the way at the wanted time
        return progress(part ** (math.log(0.5) / math.log(self.peak_time)))


@dataclass(frozen=True)
class SimulatedReach:
    """One reach: superposed submovements (Flash & Henis 1991, J. Cogn. Neurosci. 3:220-230)."""

    start: Array  # where the hand rests before, (3,) [m]
    submovements: Sequence[Submovement]
    bow: Array  # deviation from the chord at the middle of the first submovement, (3,) [m]
    end: float  # of all of them [s]

    def position(self, t: Array) -> Array:
        """Return the palm at times [s], shape (n, 3) [m]."""
        points = np.tile(self.start, (len(t), 1))
        for submovement in self.submovements:
            points += submovement.done(t)[:, None] * submovement.displacement
        done = self.submovements[0].done(t)[:, None]
        bowed: Array = points + 4.0 * done * (1.0 - done) * self.bow
        return bowed


def draw_reach(
    person: PersonParameters,
    habits: Habits,
    start: Array,
    goal: Array,
    onset: float,
    other: Array | None,
    random: np.random.Generator,
) -> SimulatedReach:
    """Draw one reach of a participant, from ``start`` to ``goal``, (3,) [m], at an onset [s].

    ``other`` is where it would go, should the person change their mind, (3,) [m] or None.
    """
    duration = max(0.5, random.normal(habits.duration, person.duration_within))
    end_point = goal + random.normal(0.0, person.end_error, 3)
    first_goal = end_point
    if other is not None and random.random() < person.change_of_mind:
        first_goal = other
    corrections = int(random.poisson(person.submovements))
    aimed = first_goal
    if corrections:
        aimed = first_goal + random.normal(0.0, person.aim_error, 3)
    # people after an injury make several: each but the last stops short
    short = 1.0 - person.undershoot * max(0, corrections - 1)
    displacement = max(0.4, short) * (aimed - start)
    movements = [Submovement(onset, duration, displacement, habits.peak_time)]
    at, now = start + displacement, onset
    if first_goal is not end_point:
        turn = np.clip(random.normal(person.change_at, 0.1), 0.15, 0.7) * duration
        movements.append(Submovement(onset + turn, duration, end_point - first_goal))
        at = at + end_point - first_goal
        now = onset + turn
    for k in range(corrections):
        left = end_point - at
        part = left if k == corrections - 1 else left * random.uniform(0.4, 0.8)
        begin = max(now, onset + duration * random.uniform(0.55, 0.85) + 0.22 * duration * k)
        movements.append(Submovement(begin, random.uniform(0.5, 0.9) * duration, part))
        at, now = at + part, begin
    if random.random() < person.hesitation:
        movements = _hesitate(movements, person.hesitation_time, random)
    chord = end_point - start
    outwards = np.array([math.copysign(1.0, start[0]) if start[0] else 1.0, 0.0, 0.0])
    bow = (
        random.normal(habits.curvature, person.curvature_within) * np.linalg.norm(chord) * outwards
    )
    bow = bow + np.array([0.0, 0.0, max(0.0, random.normal(habits.lift, person.lift_within))])
    return SimulatedReach(start, movements, bow, max(m.begin + m.duration for m in movements))


def _hesitate(
    movements: list[Submovement], pause: float, random: np.random.Generator
) -> list[Submovement]:
    """Cut the first submovement in two, with a pause between them."""
    first, *rest = movements
    part = random.uniform(0.3, 0.6)
    half = 0.6 * first.duration
    one = Submovement(first.begin, half, part * first.displacement, first.peak_time)
    two = Submovement(first.begin + half + pause, first.duration - 0.2 * half,
                      (1.0 - part) * first.displacement, first.peak_time)  # fmt: skip
    return [one, two, *(replace(m, begin=m.begin + half + pause) for m in rest)]


def tremor(person: PersonParameters, t: Array, random: np.random.Generator) -> Array:
    """Return the tremor of a hand at times [s], shape (n, 3) [m]."""
    phase = random.uniform(0.0, 2.0 * math.pi, 3)
    frequency = person.tremor_frequency * random.uniform(0.9, 1.1)
    size = person.tremor * np.abs(random.normal(0.0, 1.0, 3))
    shaken: Array = size * np.sin(2.0 * math.pi * frequency * t[:, None] + phase)
    return shaken


def sway(person: PersonParameters, t: Array, random: np.random.Generator) -> Array:
    """Return the slow drift of a resting hand at times [s], shape (n, 3) [m]."""
    frequencies = random.uniform(0.05, 0.4, (4, 3))
    phases = random.uniform(0.0, 2.0 * math.pi, (4, 3))
    waves = np.sin(2.0 * math.pi * frequencies * t[:, None, None] + phases)
    drift: Array = person.sway * waves.mean(axis=1) * math.sqrt(2.0)
    return drift
