"""Simulated reaches for the grasp candidates of objects, with what truly happened.

The palm goes from rest to where a candidate has it, by a minimum jerk whose last part follows the
candidate's approach; people take the side of an object that they are on. No person was recorded for
this: it tests whether the predictions follow the candidates, not whether people do.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.grasps.candidate import CLEARANCE, Candidate, turn_about
from igrip.grasps.candidates import candidates_of
from igrip.grasps.hand_fit import FINGER
from igrip.grips._choice import wrist_of
from igrip.lab.simulation.minimum_jerk import progress
from igrip.objects.model import ObjectModel
from igrip.observation import Observation
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])


class GraspReachConfig(Settings):
    """The person, the table and the sensors. All sizes are guesses unless said."""

    rate: float = quantity(30.0, "Hz", "measurements of the hand", "paper: 30 FPS", gt=0)
    noise: float = quantity(0.003, "m", "sd of the hand's position", ge=0)
    aim: float = quantity(0.01, "m", "sd of where the palm ends, each axis", ge=0)
    side: float = quantity(0.35, "rad", "sd of the side from which an object is taken", ge=0)
    roll: float = quantity(0.2, "rad", "sd of the roll of a grasp that leaves it free", ge=0)
    turn_noise: float = quantity(0.15, "rad", "sd of the hand's measured orientation", ge=0)
    rest: float = quantity(0.5, "s", "rest before the reach", ge=0)
    duration: float = quantity(0.9, "s", "of the reach", gt=0)
    curve: float = quantity(0.06, "m", "bow of the path against the approach", ge=0)
    lift: float = quantity(0.03, "m", "height of the path over the straight line", ge=0)
    spread: float = quantity(0.22, "m", "between neighbouring objects", gt=0)


@dataclass(frozen=True)
class GraspReach:
    """One reach, and what it is for.

    Attributes
    ----------
    messages : list of Observation
        With the hand ``right`` and the objects, by the names of their models.
    target : str
        The object that is grasped.
    grasp : Candidate
        How, world frame.
    wrist : float
        As :class:`igrip.intention.Intention` has it [rad].
    onset, end : float
        Of the movement [s].
    """

    messages: list[Observation]
    target: str
    grasp: Candidate
    wrist: float
    onset: float
    end: float

    def at(self, part: float) -> float:
        """Return the time after a part of the movement [s]."""
        return self.onset + part * (self.end - self.onset)


def draw_grasp_reach(
    models: Mapping[str, ObjectModel],
    random: np.random.Generator,
    turned: bool = False,
    config: GraspReachConfig | None = None,
) -> GraspReach | None:
    """Draw a reach for one of some objects on a table.

    Parameters
    ----------
    models : mapping of str to ObjectModel
        Up to about five; each stands as its file does.
    random : Generator
        Fixes all that is drawn.
    turned : bool
        Whether the orientation of the hand is measured, too.
    config : GraspReachConfig, optional
        Sizes.

    Returns
    -------
    GraspReach or None
        None: the object that was drawn cannot be grasped from where the hand is.
    """
    config = config or GraspReachConfig()
    start = np.array([0.15, 0.0, 0.08]) + random.normal(0.0, 0.02, 3)
    names = list(models)
    places, poses = {}, {}
    for k, slot in enumerate(random.permutation(len(names))):
        x = config.spread * (slot - 0.5 * (len(names) - 1)) + random.uniform(-0.02, 0.02)
        yaw = float(random.uniform(-math.pi, math.pi))
        spot = np.array([x, 0.42 + random.uniform(-0.06, 0.06)])
        places[names[k]] = _stand(models[names[k]], spot, turn_about(UP, yaw))
        poses[names[k]] = {
            "model": names[k], "position": places[names[k]][0].tolist(), "static": True,
            "orientation": Rotation.from_rotvec(yaw * UP).as_quat().tolist(),
        }  # fmt: skip
    target = names[int(random.integers(len(names)))]
    grasp = _draw_grasp(models[target], *places[target], start, random, config)
    if grasp is None:
        return None
    times = np.arange(0.0, config.rest + config.duration + 0.3, 1.0 / config.rate)
    goal = grasp.palm(CLEARANCE) + random.normal(0.0, config.aim, 3)
    done = progress((times - config.rest) / config.duration)[:, None]
    bow = config.lift * UP - config.curve * grasp.approach
    palms = start + (goal - start) * done + 4.0 * done * (1.0 - done) * bow
    palms = palms + random.normal(0.0, config.noise, palms.shape)
    hands = [{"position": palm.tolist()} for palm in palms]
    if turned:
        for hand, q in zip(hands, _orientations(grasp, done[:, 0], random, config), strict=True):
            hand["orientation"] = q
    messages = [
        Observation(t=float(t), hands={"right": hand}, objects={} if k else poses)
        for k, (t, hand) in enumerate(zip(times, hands, strict=True))
    ]
    chord = _level(places[target][1] @ models[target].centre + places[target][0] - start)
    wrist = wrist_of(grasp.approach, grasp.closing, chord)
    end = config.rest + config.duration
    return GraspReach(messages, target, grasp, wrist, config.rest, end)


def _stand(model: ObjectModel, spot: Array, rotation: Array) -> tuple[Array, Array]:
    """Return position and rotation of an object that stands on z = 0 with its centre at a spot."""
    centre = rotation @ model.centre
    height = -float((model.vertices @ rotation[2]).min())
    return np.array([*(spot - centre[:2]), height]), rotation


def _draw_grasp(
    model: ObjectModel, position: Array, rotation: Array, start: Array,
    random: np.random.Generator, config: GraspReachConfig,
) -> Candidate | None:  # fmt: skip
    """Return a grasp that this person can do, in the world; each kind is as likely."""
    every = []
    for candidate in candidates_of(model):
        placed = candidate._replace(
            point=position + rotation @ candidate.point,
            pivot=position + rotation @ candidate.pivot,
            approach=rotation @ candidate.approach, closing=rotation @ candidate.closing,
            axis=rotation @ candidate.axis,
        )  # fmt: skip
        chord = _level(placed.point - start)
        turn = placed.turn_to(start, chord)
        moves = np.linalg.norm(placed.turned(0.5).palm(0.0) - placed.palm(0.0)) > 1e-3
        turn += random.normal(0.0, config.side if moves else config.roll)
        placed = placed.turned(float(np.clip(turn, *placed.turns)))
        above = placed.palm(CLEARANCE)[2] > 0.04 and placed.approach[2] < 0.3
        above &= bool((placed.contacts[:, 2] - FINGER * abs(placed.closing[2]) > 0.0).all())
        if above and placed.approach @ chord > -0.2:
            every.append(placed)
    return every[int(random.integers(len(every)))] if every else None


def _orientations(
    grasp: Candidate, done: Array, random: np.random.Generator, config: GraspReachConfig
) -> list[Any]:
    """Return how the hand turns from rest, palm down, into the grasp: quaternions x, y, z, w."""
    across = np.cross(grasp.approach, grasp.closing)
    across = across if across[0] > 0.0 else -across  # as a right hand is at rest
    frame = np.stack([across, np.cross(grasp.approach, across), grasp.approach], axis=1)
    rest = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    way = Rotation.from_matrix(frame @ rest.T).as_rotvec()
    turns = Rotation.from_rotvec(np.outer(done, way)) * Rotation.from_matrix(rest)
    noise = Rotation.from_rotvec(
        random.normal(0.0, config.turn_noise / math.sqrt(3), (len(done), 3))
    )
    quaternions: list[Any] = (noise * turns).as_quat().tolist()
    return quaternions


def _level(vector: Array) -> Array:
    """Return the direction of a vector without its height; zero for a vertical one."""
    level: Array = vector * [1.0, 1.0, 0.0]
    norm = np.linalg.norm(level)
    return level / norm if norm > 1e-9 else 0.0 * level
