"""Helpers of many tests: scenes, messages, small catalogues, runs of an estimator."""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

import igrip
from igrip.errors import UnknownModelError
from igrip.geometry.scene import PlacedObject
from igrip.lab.simulation.faults import KINDS, Fault
from igrip.objects.model import build_model
from oracle.meshes import Mesh

BOX, CAN = "box:0.07x0.16x0.21", "cylinder:0.033x0.10"
UPRIGHT = [0.0, 0.0, 0.0, 1.0]
PAPER = ("003_cracker_box", "005_tomato_soup_can", "006_mustard_bottle", "021_bleach_cleanser")


class MeshCatalog(Mapping):
    """Models built from meshes in memory, by name."""

    def __init__(self, models):
        self.models = models

    @classmethod
    def of(cls, **meshes):
        return cls({name: build_model(name, mesh) for name, mesh in meshes.items()})

    def __getitem__(self, name):
        try:
            return self.models[name]
        except KeyError:
            raise UnknownModelError(f"the catalogue has no model {name!r}") from None

    def __iter__(self):
        return iter(self.models)

    def __len__(self):
        return len(self.models)


def mesh_of(vertices, faces):
    """Return a trimesh that keeps its vertices and faces as they are."""
    return trimesh.Trimesh(np.asarray(vertices, dtype=float), np.asarray(faces), process=False)


def oracle_mesh(model):
    """Return the oracle's view of a model's triangles; its frame is derived anew."""
    return Mesh(model.vertices, model.faces)


def soup(rng, count=60, size=0.05):
    """Return vertices and faces of a heap of unconnected triangles."""
    corners = rng.normal(0.0, 0.1, (count, 1, 3)) + rng.normal(0.0, size, (count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def random_turn(rng):
    """Return a random rotation."""
    return Rotation.random(rng=rng)


def placed(model, id="object", rotation=None, translation=(0.0, 0.0, 0.0), velocity=(0, 0, 0)):
    """Return a model in the world."""
    turn = np.eye(3) if rotation is None else np.asarray(rotation)
    translation = np.asarray(translation, dtype=float)
    centre = turn @ model.centre + translation
    return PlacedObject(id, model, turn, translation, centre, np.asarray(velocity, dtype=float))


# messages ----------------------------------------------------------------------------------------


def hand(position, **more):
    """Return a hand as a message has it."""
    return {"position": [float(x) for x in position], **more}


def pose(position, orientation=UPRIGHT, model=None, **more):
    """Return an object as a message has it."""
    entry = {
        "position": [float(x) for x in position],
        "orientation": [float(x) for x in orientation],
    }
    return entry | ({} if model is None else {"model": model}) | more


def message(t, hands=None, objects=None):
    """Return a message as plain data."""
    plain = {"t": float(t)}
    if hands:
        plain["hands"] = hands
    if objects:
        plain["objects"] = objects
    return plain


def minimum_jerk(start, end, duration, t):
    """Return the position at time t of a reach from rest to rest (Flash & Hogan 1985)."""
    s = np.clip(t / duration, 0.0, 1.0)
    part = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    return np.asarray(start) + part * (np.asarray(end) - np.asarray(start))


def reach(
    rng,
    objects,
    hands,
    *,
    rest=0.25,
    duration=0.8,
    after=0.15,
    hand_noise=0.002,
    object_noise=0.001,
    turn_noise=0.01,
    hand_rate=30.0,
    object_rate=12.0,
):
    """Simulate noisy reaches: hands at 30 Hz, objects at 12 Hz, each with its own older ``t``.

    ``objects``: {id: (model, position, Rotation, velocity)}; ``hands``: {id: (start, end)}.
    Returns messages in the order of their arrival.
    """
    arrivals = []
    for index in range(int((rest + duration + after) * hand_rate)):
        t = 0.1 + index / hand_rate + rng.uniform(-0.002, 0.002)
        for id, (start, end) in hands.items():
            own = t + rng.uniform(0.0, 0.003)
            where = minimum_jerk(start, end, duration, own - 0.1 - rest)
            where = where + rng.normal(0.0, hand_noise, 3)
            arrivals.append((t + 0.03, "hands", id, hand(where, t=own)))
    for index in range(-2, int((rest + duration + after) * object_rate)):
        t = max(0.0, 0.1 + index / object_rate + rng.uniform(-0.003, 0.003))
        for id, (model, position, turn, velocity) in objects.items():
            where = np.asarray(position) + t * np.asarray(velocity) + rng.normal(0, object_noise, 3)
            noisy = Rotation.from_rotvec(rng.normal(0.0, turn_noise, 3)) * turn
            arrivals.append((t + 0.09, "objects", id, pose(where, noisy.as_quat(), model, t=t)))
    arrivals.sort(key=lambda row: row[0])
    messages = []
    for t, kind, id, entry in arrivals:
        if not messages or messages[-1]["t"] != t:
            messages.append({"t": t})
        messages[-1].setdefault(kind, {})[id] = entry
    return messages


def scene_of_shapes(rng, *, hands=("left", "right"), moving=False):
    """Return messages with a box and two cans and hands that go for two of them."""
    drift = (0.3, 0.1, 0.0) if moving else (0.0, 0.0, 0.0)
    objects = {
        "box": (BOX, (0.30, 0.20, 0.10), random_turn(rng), (0.0, 0.0, 0.0)),
        "can": (CAN, (0.35, -0.15, 0.05), random_turn(rng), drift),
        "tin": (CAN, (0.10, 0.35, 0.05), random_turn(rng), (0.0, 0.0, 0.0)),
    }
    ends = {"left": "tin", "right": "box", "third": "can"}
    goals = {
        id: (rng.normal(0.0, 0.03, 3), np.asarray(objects[ends[id]][1]) + [0.0, 0.0, 0.05])
        for id in hands
    }
    return reach(rng, objects, goals, rest=0.1, duration=0.5, after=0.0)


# runs --------------------------------------------------------------------------------------------


def run(messages, catalog, config=None, estimator=None):
    """Return all intentions that a fresh (or the given) estimator gives for plain messages."""
    estimator = estimator or igrip.Estimator(catalog, config)
    intentions = []
    for plain in messages:
        intentions += estimator.update(igrip.Observation(**plain))
    return intentions


def feed(estimator, *messages):
    """Return the intentions of the last of some plain messages, by hand."""
    for plain in messages:
        intentions = estimator.update(igrip.Observation(**plain))
    return {intention.hand: intention for intention in intentions}


def lines(intentions):
    """Return intentions as bytes, to be compared to the last bit."""
    return [intention.to_json() for intention in intentions]


def close(a, b, tolerance=1e-6):
    """Whether two nested plain structures agree, numbers within an absolute tolerance."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(close(a[key], b[key], tolerance) for key in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(map(lambda x, y: close(x, y, tolerance), a, b))
    numbers = isinstance(a, int | float) and isinstance(b, int | float)
    return abs(a - b) <= tolerance if numbers else a == b


def plain_json(value):
    """Return a structure as JSON gives it back."""
    return json.loads(json.dumps(value))


def every_kind(rate: float, lasts: float = 0.3) -> list[Fault]:
    """Return faults of every kind at random, ``rate`` a second in all."""
    return [Fault(kind, lasts=lasts, rate=rate / len(KINDS)) for kind in KINDS]
