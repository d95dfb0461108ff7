"""The frame's geometry: hands × objects, measured by one call of the compiled kernel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from igrip.entities import Vector
from igrip.geometry import kernel
from igrip.geometry.bvh import Bvh
from igrip.motion.trajectory import Motion
from igrip.objects.model import ObjectModel
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))


class RayConfig(Settings):
    """Cones of rays from the predicted points, and the search for contact."""

    rays: int = quantity(36, "1", "rays in a cone, its axis included", "DESIGN §7", ge=1, le=1000)
    slow_speed: float = quantity(0.03, "m/s", "at or below it the cone is widest", "SPEC §4", ge=0)
    slow_angle: float = quantity(
        math.radians(25.0), "rad", "half-angle at slow_speed", "SPEC §4", gt=0, lt=1.5
    )
    fast_speed: float = quantity(
        0.8, "m/s", "at or above it the cone is narrowest", "SPEC §4", gt=0
    )
    fast_angle: float = quantity(
        math.radians(8.0), "rad", "half-angle at fast_speed", "SPEC §4", gt=0, lt=1.5
    )
    least_speed: float = quantity(
        0.03,
        "m/s",
        "a slower predicted point has no direction, so no cone",
        "as cues.least_speed",
        ge=0,
    )
    contact_distance: float = quantity(
        0.08, "m", "palm to surface when a grasp closes", "SPEC §9", ge=0
    )
    contact_horizon: float = quantity(2.0, "s", "contact is looked for until then", "SPEC §9", gt=0)

    @model_validator(mode="after")
    def _ordered(self) -> RayConfig:
        if not self.slow_speed < self.fast_speed:
            raise ValueError("slow_speed must be less than fast_speed")
        return self


@dataclass(frozen=True, slots=True)
class Placed:
    """An object in the world.

    Attributes
    ----------
    id : str
        Its id in the messages.
    model : ObjectModel
        Its model.
    rotation, translation : (3, 3), (3,)
        World-from-mesh pose [m].
    centre : (3,)
        Centre of gravity, world frame [m].
    velocity : (3,)
        Of that centre, world frame [m/s].
    """

    id: str
    model: ObjectModel
    rotation: Array
    translation: Array
    centre: Array
    velocity: Array


@dataclass(frozen=True, slots=True)
class Geometry:
    """One hand against every object, in the order of ``objects``. Arrays of shape (o,).

    Attributes
    ----------
    objects : sequence of Placed
        The objects.
    hits : int64
        Rays of the cones that meet the mesh.
    vertex, surface : float64
        From the hand to the nearest vertex and surface point [m].
    future_vertex, future_surface : float64
        The same from the barycentre of the predicted points [m].
    centre, centre_rate : float64
        Distance to the centre of gravity and its time derivative [m, m/s].
    axial : float64
        z of the hand in the object frame [m].
    half_length : float64
        Half the length of the bounding cylinder [m].
    spread : float
        d_max: largest distance between two centres [m]; NaN for fewer than two objects.
    """

    objects: Sequence[Placed]
    hits: NDArray[np.int64]
    vertex: Array
    surface: Array
    future_vertex: Array
    future_surface: Array
    centre: Array
    centre_rate: Array
    axial: Array
    half_length: Array
    spread: float


class Packed(NamedTuple):
    """Trees of several meshes one after the other, replaced as a whole when a mesh is added."""

    models: dict[str, ObjectModel]
    number: dict[str, int]
    bvh: Bvh
    starts: NDArray[np.int64]
    spheres: Array
    axes: Array
    origins: Array
    half_lengths: Array


def _pack(models: dict[str, ObjectModel]) -> Packed:
    trees = [model.bvh for model in models.values()]
    empty = Bvh(np.empty((0, 12), np.float32), np.empty((0, 2), np.int32), np.empty((0, 9)))
    nodes = np.cumsum([0, *(len(tree.boxes) for tree in trees)])[:-1]
    triangles = np.cumsum([0, *(len(tree.triangles) for tree in trees)])[:-1]
    frames = [model.mesh_from_object[:3, :3] for model in models.values()]
    return Packed(
        models=models,
        number={name: number for number, name in enumerate(models)},
        bvh=Bvh(*(np.concatenate(parts) for parts in zip(empty, *trees, strict=True))),
        starts=np.stack([nodes, triangles], axis=1).astype(np.int64),
        spheres=np.array([model.sphere for model in models.values()]).reshape(-1, 4),
        axes=np.array(frames).reshape(-1, 3, 3),
        origins=np.array([model.origin for model in models.values()]).reshape(-1, 3),
        half_lengths=np.array([0.5 * model.length for model in models.values()]),
    )


class Scene:
    """Holds the trees of all meshes that have appeared, and measures hands against objects.

    Parameters
    ----------
    config : RayConfig
        Cones and contact.

    Attributes
    ----------
    counters : (3,) int64
        Tree nodes visited by rays, by nearest-point queries, and rays cast, since the beginning.
    """

    def __init__(self, config: RayConfig) -> None:
        self._config = config
        self._cone = np.array(
            [
                config.slow_speed, config.slow_angle, config.fast_speed, config.fast_angle,
                config.least_speed,
            ]
        )  # fmt: skip
        self._pattern = ray_pattern(config.rays)
        self._packed = _pack({})
        self.counters = np.zeros(3, dtype=np.int64)

    def _pack_with(self, objects: Sequence[Placed]) -> Packed:
        """Return the trees of all meshes known so far, those of these objects among them."""
        packed = self._packed
        missing = {o.model.name: o.model for o in objects if o.model.name not in packed.number}
        if missing:
            packed = self._packed = _pack({**packed.models, **missing})
        return packed

    def measure(self, hands: Sequence[Motion], objects: Sequence[Placed]) -> list[Geometry]:
        """Measure every hand against every object; one :class:`Geometry` per hand."""
        count = len(objects)
        if not hands or not count:
            return [_nothing() for _ in hands]
        packed = self._pack_with(objects)
        models = np.array([packed.number[o.model.name] for o in objects], dtype=np.int64)
        centres = np.array([o.centre for o in objects])
        hits = np.zeros((len(hands), count), dtype=np.int64)
        distances = np.empty((5, len(hands), count))
        centre_rates, axial = np.empty((len(hands), count)), np.empty((len(hands), count))
        kernel.measure(
            *packed.bvh, packed.starts, packed.spheres, packed.axes, packed.origins, models,
            np.array([o.rotation for o in objects]), np.array([o.translation for o in objects]),
            centres, np.array([o.velocity for o in objects]),
            np.array([hand.position for hand in hands]),
            np.array([hand.velocity for hand in hands]),
            np.array([hand.future for hand in hands]),
            np.array([hand.future_velocity for hand in hands]),
            self._pattern, self._cone, hits, distances, centre_rates, axial, self.counters,
        )  # fmt: skip
        half_lengths, spread = packed.half_lengths[models], kernel.spread(centres)
        return [
            Geometry(
                objects=objects,
                hits=hits[h],
                vertex=distances[0, h],
                surface=distances[1, h],
                future_vertex=distances[2, h],
                future_surface=distances[3, h],
                centre=distances[4, h],
                centre_rate=centre_rates[h],
                axial=axial[h],
                half_length=half_lengths,
                spread=spread,
            )
            for h in range(len(hands))
        ]

    def contact(self, hand: Motion, target: Placed) -> tuple[float, Vector] | None:
        """Predict when the hand is within grasping distance of an object, and where it touches.

        Returns
        -------
        time, point : float, 3 floats
            Seconds from the hand's newest sample, and the nearest surface point then, world frame
            [m]. None: not within the horizon.
        """
        packed = self._pack_with([target])
        model = packed.number[target.model.name]
        out = np.empty(4)
        kernel.approach(
            *packed.bvh, packed.starts[model], target.rotation, target.translation,
            hand.coefficients, self._config.contact_distance, self._config.contact_horizon, out,
        )  # fmt: skip
        if math.isnan(out[0]):
            return None
        x, y, z = target.rotation @ out[1:] + target.translation
        return float(out[0]), (float(x), float(y), float(z))

    def impacts(self, hand: Motion, target: Placed) -> tuple[Array, Array]:
        """Cast the rays of one pair again, to be drawn.

        Returns
        -------
        directions : (f, r, 3)
            World frame; not unit vectors. NaN where a predicted point has no cone.
        lengths : (f, r)
            To the first impact in units of the direction; infinity for a miss.
        """
        packed = self._pack_with([target])
        model = packed.number[target.model.name]
        directions = np.empty((len(hand.future), len(self._pattern), 3))
        lengths = np.empty((len(hand.future), len(self._pattern)))
        kernel.cone_impacts(
            *packed.bvh, packed.starts[model], packed.spheres[model], packed.axes[model],
            target.rotation, target.translation, hand.future, hand.future_velocity,
            self._pattern, self._cone, directions, lengths,
        )  # fmt: skip
        return directions, lengths


def ray_pattern(rays: int) -> Array:
    """Return points on the unit disc, evenly spread, the first its centre, shape (rays, 2)."""
    k = np.arange(rays)
    radius = np.sqrt(k / max(1, rays - 1))
    angle = GOLDEN_ANGLE * np.maximum(0, k - 1)  # the first ray off the axis leans along u
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _nothing() -> Geometry:
    none = np.empty(0)
    return Geometry(
        [], np.empty(0, dtype=np.int64), none, none, none, none, none, none, none, none, math.nan
    )
