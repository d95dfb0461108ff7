"""The table of the experiment: where objects stand, and where a palm is when it grasps one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from igrip.lab.simulation.minimum_jerk import Array
from igrip.lab.simulation.parameters import ProtocolParameters
from igrip.objects.catalog import PAPER_OBJECTS, Catalog
from igrip.objects.model import ObjectModel


class GraspGap(Protocol):
    """Distance of a palm from what it grasps."""

    @property
    def palm_to_body(self) -> float:
        """To the surface, in a palmar grasp [m]."""

    @property
    def palm_to_top(self) -> float:
        """To the top, in a pinch [m]."""


@dataclass(frozen=True)
class Table:
    """Objects, by id, that stand upright on the plane z = 0."""

    models: Mapping[str, ObjectModel]
    places: Mapping[str, Array]  # origin of each mesh, (3,) [m]
    yaws: Mapping[str, float]  # about the vertical [rad]

    def rotation(self, id: str) -> Array:
        """Return world-from-mesh of an object, shape (3, 3)."""
        return yaw_rotation(self.yaws[id])

    def middle(self, id: str) -> Array:
        """Return the mid-point of an object's cylinder, shape (3,) [m]."""
        point: Array = self.places[id] + self.rotation(id) @ self.models[id].origin
        return point

    def grasp_point(self, id: str, grip: str, hand: Array, gap: GraspGap) -> Array:
        """Return where the palm is at the end of a reach from ``hand``, shape (3,) [m].

        A palmar grip ends beside the body at mid-height, on the side of the hand; a pinch above
        the top. ``gap`` is the distance to them.
        """
        model, middle = self.models[id], self.middle(id)
        if grip == "pinch":
            above: Array = middle + [0.0, 0.0, 0.5 * model.length + gap.palm_to_top]
            return above
        aside = hand[:2] - middle[:2]
        aside = aside / np.linalg.norm(aside)
        corners = (model.vertices @ self.rotation(id).T + self.places[id])[:, :2] - middle[:2]
        away = (float((corners @ aside).max()) + gap.palm_to_body) * aside
        beside: Array = middle + [away[0], away[1], 0.0]
        return beside


def object_ids() -> list[str]:
    """Return the ids of the paper's objects in the recordings."""
    return [name.split("_")[-2] for name in PAPER_OBJECTS]


def models_by_id(catalog: Catalog) -> dict[str, ObjectModel]:
    """Return the paper's objects."""
    return {id: catalog[name] for id, name in zip(object_ids(), PAPER_OBJECTS, strict=True)}


def yaw_rotation(yaw: float) -> Array:
    """Return a turn about the vertical [rad], shape (3, 3)."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def stand_at(model: ObjectModel, spot: Array, yaw: float) -> Array:
    """Return the origin, (3,) [m], of an upright mesh with its middle over a spot (2,) [m]."""
    c, s = math.cos(yaw), math.sin(yaw)
    x, y = model.origin[:2]
    lowest = float(model.vertices[:, 2].min())
    return np.array([spot[0] - (c * x - s * y), spot[1] - (s * x + c * y), -lowest])


def set_table(
    models: Mapping[str, ObjectModel], protocol: ProtocolParameters, random: np.random.Generator
) -> Table:
    """Place objects at random between the hands' rest and the screen, not too close together."""
    half = 0.5 * protocol.table_width
    while True:
        spots: list[Array] = []
        for _ in range(200 * len(models)):
            spot = random.uniform([-half, protocol.table_near], [half, protocol.table_far])
            if all(np.linalg.norm(spot - other) >= protocol.separation for other in spots):
                spots.append(spot)
            if len(spots) == len(models):
                break
        else:
            continue  # an unlucky beginning: there is no room left; begin anew
        yaws = {id: float(random.uniform(-math.pi, math.pi)) for id in models}
        places = {
            id: stand_at(model, spot, yaws[id])
            for (id, model), spot in zip(models.items(), spots, strict=True)
        }
        return Table(models, places, yaws)
