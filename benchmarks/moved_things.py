"""Things that a hand carries over a table before a rendered camera, with the truth beside."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmarks.worn_arms import WRIST, ArmFilm, ArmPose, table_before
from igrip.lab.rendering.layout import PlacedMesh
from igrip.objects.catalog import PAPER_OBJECTS, Catalog
from igrip.objects.model import ObjectModel
from igrip.rgbd import RgbdFrame

Array = NDArray[np.float64]
RATE = 30.0  # frames a second
PALM_TO_SKIN = 0.018  # from the middle of the palm to its skin [m]
ARM = 0.30  # from the palm to the elbow [m]
AWAY = 0.30  # from where a hand comes, and where it goes [m]
COMES, HOLDS, GOES, RESTS = 0.5, 0.2, 0.5, 0.7  # s
SPEEDS_UP = 0.10  # s to the full speed, and to a stop
LIFT = 0.09  # m
KIND = "bare, open"


@dataclass(frozen=True)
class Moment:
    """One frame of a film: what is where, in the world (z up, the table at 0)."""

    t: float  # s
    phase: str  # "alone", "moves", "held" or "released"
    pose: Array  # (4, 4), world from mesh of what is moved
    arm: ArmPose


@dataclass(frozen=True, eq=False)
class MovedThing:
    """A thing, what else stands there, and how it is moved.

    ``grip`` is the side of the thing on which the hand is: ``"right"``, ``"left"`` (of the person,
    who sits at -y) or ``"above"``.
    """

    name: str
    film: ArmFilm
    moments: tuple[Moment, ...]

    def frames(self) -> Iterator[tuple[Moment, RgbdFrame, Array]]:
        """Render; yield each moment, its frame and the hand's landmarks, (21, 2) [pixels]."""
        for moment in self.moments:
            objects = dict(self.film.scene.objects)
            objects[self.name] = PlacedMesh(objects[self.name].model, moment.pose)
            frame = self.film.frame(moment.t, {"hand": (KIND, moment.arm)}, objects)
            yield moment, frame, self.landmarks(moment.arm)

    def landmarks(self, arm: ArmPose) -> Array:
        """Return where the hand's joints are in the picture, (21, 2) [pixels]."""
        scene = self.film.scene
        world = joints() @ arm.matrix()[:3, :3].T + arm.palm
        camera_from_world = np.linalg.inv(scene.world_from_camera)
        there = world @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
        return np.asarray(scene.intrinsics.pixels(there))


def joints() -> Array:
    """Return the joints of the open hand of :mod:`benchmarks.worn_arms`, (21, 3), its frame [m]."""
    bend = np.radians(85.0) * 0.05
    result = [np.array([WRIST, 0.0, 0.0])]
    root, joint, tip = (-0.03, 0.03, -0.005), (0.02, 0.061, -0.012), (0.05, 0.0605, -0.015)
    thumb = np.array([root, joint, tip])
    result += [thumb[0], 0.5 * (thumb[0] + thumb[1]), thumb[1], thumb[2]]
    for k, length in enumerate((0.075, 0.085, 0.080, 0.062)):
        knuckle = np.array([0.030, 0.032 - 0.021 * k, 0.0])
        first = knuckle + 0.5 * length * np.array([np.cos(bend), 0.0, -np.sin(bend)])
        more = 1.9 * bend
        second = first + 0.5 * length * np.array([np.cos(more), 0.0, -np.sin(more)])
        result += [knuckle, first, 0.5 * (first + second), second]
    return np.array(result)


def moved_thing(
    catalog: Catalog, seed: int, speed: float, moved: str = "carried", distance: float = 0.36
) -> MovedThing:
    """Return a thing of the paper's four, moved at a speed [m/s]; another seed is another one.

    ``moved``: ``"carried"`` through the air, or ``"pushed"`` over the table. Half of those that are
    carried are turned meanwhile.
    """
    random = np.random.default_rng([seed, 7])
    name = PAPER_OBJECTS[seed % len(PAPER_OBJECTS)]
    model = catalog[name]
    side = float(random.choice([-1.0, 1.0]))
    start = np.array([-side * 0.5 * distance, random.uniform(-0.10, 0.02)])
    end = np.array([side * 0.5 * distance, random.uniform(-0.10, 0.02)])
    yaw = random.uniform(-np.pi, np.pi)
    turned = moved == "carried" and bool(random.integers(2))
    turn = np.radians([random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-40, 40)])
    grip = "right" if side > 0 else "left"
    if moved == "carried" and model.vertices[:, 2].max() < 0.15 and random.random() < 0.5:
        grip = "above"
    objects = {name: PlacedMesh(model, np.eye(4))}
    others = [other for other in PAPER_OBJECTS if other != name]
    for other, x in zip(random.permutation(others)[:2], (-0.2, 0.2), strict=True):
        pose = _standing(catalog[str(other)], np.array([x, 0.19]), random.uniform(-np.pi, np.pi))
        objects[str(other)] = PlacedMesh(catalog[str(other)], pose)
    film = table_before(
        azimuth=random.uniform(-40, 40), elevation=random.uniform(35, 50),
        distance=random.uniform(0.8, 1.0), objects=objects, seed=seed,
    )  # fmt: skip
    begin = _standing(model, start, yaw)
    objects[name] = PlacedMesh(model, begin)
    hand = _arm_at(model, begin, grip)
    length = float(np.linalg.norm(end - start))
    duration = length / speed + SPEEDS_UP
    moments = []
    for k in range(round((COMES + HOLDS + duration + HOLDS + GOES + RESTS) * RATE)):
        t = k / RATE
        since = t - COMES - HOLDS
        share = _travelled(since, duration)
        pose = begin.copy()
        if turned:
            about = Rotation.from_rotvec(turn * share).as_matrix()
            middle = pose[:3, :3] @ model.sphere[:3] + pose[:3, 3]
            pose[:3, :3] = about @ pose[:3, :3]
            pose[:3, 3] = middle - pose[:3, :3] @ model.sphere[:3]
        shift = np.append(share * (end - start), 0.0)
        if moved == "carried":  # it may not sink into the table where it is turned
            shift[2] = LIFT * np.sin(np.pi * share) ** 0.5 if 0.0 < share < 1.0 else 0.0
        pose[:3, 3] += shift
        if turned:
            lowest = (model.vertices @ pose[2, :3] + pose[2, 3]).min()
            pose[2, 3] -= min(lowest, 0.0)
        away = 0.0
        if t < COMES:
            away = 1.0 - t / COMES
        elif since > duration + HOLDS:
            away = min(1.0, (since - duration - HOLDS) / GOES)
        phase = (
            "alone" if t < COMES else "held" if since < 0 else "moves" if since < duration
            else "held" if since < duration + HOLDS else "released"
        )  # fmt: skip
        moments.append(Moment(t, phase, pose, _moved_arm(hand, shift, away)))
    return MovedThing(name, film, tuple(moments))


def _standing(model: ObjectModel, at: Array, yaw: float) -> Array:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("z", yaw).as_matrix()
    pose[:2, 3] = at - (pose[:3, :3] @ model.sphere[:3])[:2]
    pose[2, 3] = -model.vertices[:, 2].min()
    return pose


def _arm_at(model: ObjectModel, pose: Array, grip: str) -> ArmPose:
    """Return an arm whose palm touches a thing."""
    points = model.vertices @ pose[:3, :3].T + pose[:3, 3]
    low, high = points.min(axis=0), points.max(axis=0)
    middle = 0.5 * (low + high)
    if grip == "above":
        palm = np.array([middle[0], middle[1] - 0.02, high[2] + PALM_TO_SKIN])
        return ArmPose(palm, palm + ARM * np.array([0.0, -0.9, 0.4]), 0.0)
    side = 1.0 if grip == "right" else -1.0
    height = max(0.06, 0.6 * high[2])
    near = points[np.abs(points[:, 2] - height) < 0.02]  # as wide as it is there
    x = (near[:, 0] * side).max() * side + side * PALM_TO_SKIN
    palm = np.array([x, middle[1] - 0.03, height])
    return ArmPose(palm, palm + ARM * np.array([0.3 * side, -0.9, 0.35]), side * np.pi / 2)


def _moved_arm(arm: ArmPose, shift: Array, away: float) -> ArmPose:
    back = AWAY * away * (arm.elbow - arm.palm) / ARM
    back = back + shift
    return ArmPose(arm.palm + back, arm.elbow + back, arm.roll)


def _travelled(t: float, duration: float) -> float:
    """Return the share of the way after a time [s]; its speed is even but for begin and end."""
    t = min(max(t, 0.0), duration)
    full = duration - SPEEDS_UP
    if t < SPEEDS_UP:
        return 0.5 * t**2 / SPEEDS_UP / full
    if t > duration - SPEEDS_UP:
        return 1.0 - 0.5 * (duration - t) ** 2 / SPEEDS_UP / full
    return (t - 0.5 * SPEEDS_UP) / full
