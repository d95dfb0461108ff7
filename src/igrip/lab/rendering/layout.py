"""Where objects are in a rendered scene, and a camera that looks at them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from igrip.lab.simulation.table import yaw_rotation
from igrip.objects.model import ObjectModel
from igrip.objects.stable_poses import stable_poses
from igrip.rgbd import Array
from igrip.settings import Settings, quantity

MAX_TRIES, SAME_TURN = 600, 20  # of an object; and of them with the same turn
GRID = 0.004  # of footprints [m]


class LayoutConfig(Settings):
    """How objects are scattered and where the camera stands."""

    width: float = quantity(0.60, "m", "objects stand within it, left to right", "guess", gt=0)
    depth: float = quantity(0.40, "m", "and within it, away from the camera", "guess", gt=0)
    min_gap: float = quantity(0.03, "m", "between two objects", "the stated bar", ge=0)
    lying: float = quantity(0.3, "1", "probability that an object does not stand", "guess", ge=0)
    # ranges of the camera: a demonstrator on a tripod, guess
    distance: tuple[float, float] = (0.7, 1.0)  # from the middle of the scene [m]
    elevation: tuple[float, float] = (30.0, 50.0)  # at which it looks down [degrees]


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh and its pose, shape (4, 4), world from mesh."""

    model: ObjectModel
    pose: Array


def scatter(
    models: Sequence[ObjectModel], config: LayoutConfig, random: np.random.Generator
) -> list[PlacedMesh]:
    """Put objects on the table z = 0, each at least ``config.min_gap`` from the others.

    Raises
    ------
    ValueError
        If they do not fit.
    """
    placed: list[PlacedMesh] = []
    covered: list[cKDTree] = []
    for model in models:
        ways = stable_poses(model.vertices, model.centre)
        lies = len(ways.heights) > 1 and random.random() < config.lying
        way = 0
        if lies:
            chances = ways.probabilities[1:] / ways.probabilities[1:].sum()
            way = 1 + int(random.choice(len(chances), p=chances))
        for attempt in range(MAX_TRIES):
            if attempt % SAME_TURN == 0:  # its footprint moves along with it: computed once a turn
                pose = np.eye(4)
                pose[:3, :3] = yaw_rotation(random.uniform(-np.pi, np.pi)) @ ways.rotations[way]
                pose[2, 3] = ways.heights[way]
                middle = pose[:3, :3] @ model.sphere[:3]
                own = footprint(model, pose)
            spot = np.array([config.width, config.depth]) * (random.random(2) - 0.5) - middle[:2]
            moved = own + spot
            gaps = [float(np.min(tree.query(moved)[0])) for tree in covered]
            if all(gap >= config.min_gap + GRID for gap in gaps):
                pose[:2, 3] = spot
                placed.append(PlacedMesh(model, pose))
                covered.append(cKDTree(moved))
                break
        else:
            raise ValueError(f"{model.name}: no room left on the table")
    return placed


def footprint(model: ObjectModel, pose: Array) -> Array:
    """Return what a mesh covers of the table, seen from above: points of a grid, shape (n, 2)."""
    triangles = model.vertices[model.faces]
    points = np.concatenate([model.vertices, triangles.mean(axis=1)])
    flat = (points @ pose[:3, :3].T + pose[:3, 3])[:, :2]
    cells: Array = np.unique(np.round(flat / GRID), axis=0) * GRID
    return cells


def random_camera(config: LayoutConfig, random: np.random.Generator) -> Array:
    """Return world-from-camera, shape (4, 4), of a camera in front of the table (at -y)."""
    distance = random.uniform(*config.distance)
    elevation = np.radians(random.uniform(*config.elevation))
    azimuth = np.radians(random.uniform(-20.0, 20.0))
    away = np.array([
        np.cos(elevation) * np.sin(azimuth), -np.cos(elevation) * np.cos(azimuth), np.sin(elevation)
    ])  # fmt: skip
    return look_at(np.array([0.0, 0.0, 0.07]) + distance * away, np.array([0.0, 0.0, 0.07]))


def look_at(eye: Array, target: Array) -> Array:
    """Return world-from-camera of a level camera at ``eye`` that looks at ``target``."""
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right = right / np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(ahead, right), ahead], axis=1)
    pose[:3, 3] = eye
    return pose
