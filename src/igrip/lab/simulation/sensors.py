"""A simulated camera at shoulder level: noise, losses and wrong labels of hands and objects."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.lab.simulation.parameters import CameraParameters
from igrip.lab.simulation.table import Table
from igrip.objects.model import ObjectModel
from igrip.observation import Observation

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Poses = Callable[[float], tuple[Array, Array]]
"""From a time to world-from-mesh rotation and translation of an object."""


def place_camera(camera: CameraParameters, side: str, random: np.random.Generator) -> Array:
    """Return where the camera on one side stands for one participant, shape (3,) [m]."""
    x = -camera.aside if side == "left" else camera.aside
    spot: Array = np.array([x, -camera.behind, camera.height])
    return spot + random.normal(0.0, camera.placement, 3)


def measure_points(
    points: Array, camera_at: Array, camera: CameraParameters, random: np.random.Generator
) -> Array:
    """Return points of a trace as the camera measures them, shape (n, 3) [m].

    The depth of a stereo camera is uncertain by ``z² · sd of the disparity / (focal · baseline)``.
    """
    sight = points - camera_at
    z = np.linalg.norm(sight, axis=1)
    along = sight / z[:, None]
    noise = _correlated(len(points), camera.correlation, random)
    across = noise - (noise * along).sum(axis=1, keepdims=True) * along
    depth_sd = z * z * camera.disparity_noise / (camera.focal * camera.baseline)
    depth = depth_sd * _correlated(len(points), camera.correlation, random)[:, 0]
    wild = random.random(len(points)) < camera.outliers
    depth = depth + wild * random.normal(0.0, camera.outlier_size, len(points))
    measured: Array = points + camera.lateral_noise * across + depth[:, None] * along
    return measured


def _correlated(n: int, correlation: float, random: np.random.Generator) -> Array:
    """Return noise of unit variance, shape (n, 3), of a first-order autoregression."""
    drawn = random.normal(0.0, 1.0, (n, 3))
    for k in range(1, n):
        drawn[k] = correlation * drawn[k - 1] + math.sqrt(1.0 - correlation**2) * drawn[k]
    return drawn


def lose(probability: Array, mean_length: float, random: np.random.Generator) -> Flags:
    """Return which frames are lost: bursts that begin with a probability for each frame."""
    lost = np.zeros(len(probability), dtype=bool)
    for k in np.flatnonzero(random.random(len(probability)) < probability):
        lost[k : k + int(random.geometric(1.0 / mean_length))] = True
    return lost


class ObjectDetector:
    """Poses of the objects of one recording, at their own slower rate."""

    def __init__(
        self, table: Table, camera_at: Array, camera: CameraParameters, random: np.random.Generator
    ) -> None:
        self._table, self._at, self._camera, self._random = table, camera_at, camera, random
        self._bias = {id: random.normal(0.0, camera.object_bias, 3) for id in table.models}
        self._turn = {
            id: Rotation.from_rotvec(random.normal(0.0, camera.object_bias_turn, 3))
            for id in table.models
        }
        self._left = dict.fromkeys(table.models, 0)  # poses for which it is still lost
        self._never = {id for id in table.models if random.random() < camera.never_found}

    def detect(
        self, t: float, hands: Mapping[str, Array], moving: Mapping[str, Poses]
    ) -> dict[str, dict[str, Any] | None]:
        """Return every object as detected at ``t`` [s]; None for those that were not."""
        return {id: self._one(id, t, hands, moving.get(id)) for id in self._table.models}

    def _one(
        self, id: str, t: float, hands: Mapping[str, Array], moving: Poses | None
    ) -> dict[str, Any] | None:
        camera, random, model = self._camera, self._random, self._table.models[id]
        rotation, translation = (
            (self._table.rotation(id), self._table.places[id])
            if moving is None
            else moving(max(0.0, t - camera.object_latency))
        )
        if self._left[id] == 0 and random.random() < camera.object_lost:
            self._left[id] = int(random.geometric(1.0 / camera.object_lost_for))
        middle = translation + rotation @ model.origin
        hidden = any(self._hides(palm, middle) for palm in hands.values())
        if self._left[id]:
            self._left[id] -= 1
            return None
        if id in self._never or (hidden and random.random() < camera.occluded):
            return None
        turned = Rotation.from_matrix(rotation)
        if random.random() < camera.flips:
            turned = turned * _flip(model, random)
            translation = middle - turned.apply(model.origin)
        jitter = Rotation.from_rotvec(random.normal(0.0, camera.object_jitter_turn, 3))
        detected = jitter * self._turn[id] * turned
        place = middle - detected.apply(model.origin) + self._bias[id]
        return {
            "model": model.name,
            "t": max(0.0, round(t - camera.object_latency, 4)),
            "position": place + random.normal(0.0, camera.object_jitter, 3),
            "orientation": detected.as_quat(),
        }

    def _hides(self, palm: Array, middle: Array) -> bool:
        """Whether the forearm behind a palm is between the camera and a point."""
        elbow = palm + [math.copysign(0.08, palm[0]), -0.24, 0.06]
        for part in np.linspace(0.0, 1.0, 6):
            point = palm + part * (elbow - palm)
            sight, towards = middle - self._at, point - self._at
            along = float(towards @ sight) / float(sight @ sight)
            across = float(np.linalg.norm(towards - along * sight))
            if 0.0 < along < 0.95 and across < self._camera.arm_radius:
                return True
        return False


def _flip(model: ObjectModel, random: np.random.Generator) -> Rotation:
    """Return a turn by which a detector confuses an object with itself, in its mesh frame."""
    axes = model.mesh_from_object[:3, :3]
    if model.symmetry == "cylinder":
        return Rotation.from_rotvec(random.uniform(-math.pi, math.pi) * axes[:, 2])
    column = int(random.integers(3)) if model.symmetry == "box" else 2
    return Rotation.from_rotvec(math.pi * axes[:, column])


def observe_scene(
    times: Array,
    palms: Mapping[str, Array],
    table: Table,
    camera_at: Array,
    camera: CameraParameters,
    random: np.random.Generator,
    moving: Mapping[str, Poses] | None = None,
) -> list[Observation]:
    """Return the messages of a camera that observes a scene.

    ``times`` (n,) are those of the frames [s], ``palms`` where each truly is, (n, 3) [m],
    ``camera_at`` where the camera stands, (3,) [m]; ``moving`` are objects that do not rest.
    """
    step = float(times[1] - times[0])
    measured, lost = {}, {}
    for hand, points in palms.items():
        measured[hand] = measure_points(points, camera_at, camera, random)
        speed = np.linalg.norm(np.gradient(points, step, axis=0), axis=1)
        chance = camera.lost * (1.0 + (camera.moving_lost - 1.0) * np.minimum(speed, 1.5))
        lost[hand] = lose(chance, camera.lost_for, random)
    detector = ObjectDetector(table, camera_at, camera, random)
    next_pose = random.uniform(0.0, 1.0 / camera.object_rate)
    messages = []
    for k, t in enumerate(times.tolist()):
        hands: dict[str, Any] = {
            hand: None if lost[hand][k] else {"position": points[k]}
            for hand, points in measured.items()
        }
        _mislabel(hands, camera, random)
        objects: dict[str, Any] = {}
        if t >= next_pose:
            next_pose += 1.0 / camera.object_rate
            at = {hand: points[k] for hand, points in palms.items()}
            objects = detector.detect(t, at, moving or {})
        messages.append(Observation(t=round(t, 6), hands=hands, objects=objects))
    return messages


def _mislabel(hands: dict[str, Any], camera: CameraParameters, random: np.random.Generator) -> None:
    """Now and then swap the labels of the hands, or give one hand both."""
    if len(hands) != 2:
        return
    (a, first), (b, second) = hands.items()
    if random.random() < camera.swapped:
        hands[a], hands[b] = second, first
    elif random.random() < camera.duplicated:
        source = first or second
        hands[a] = hands[b] = source
