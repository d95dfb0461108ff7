"""Geometry of a frame: hands × objects, measured by one call of the compiled kernel."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from igrip.entities import Vector
from igrip.geometry import kernel
from igrip.geometry.cones import Cones, ray_pattern
from igrip.geometry.contact import approach
from igrip.geometry.cylinder import Cylinders, place_cylinders
from igrip.geometry.drawn_rays import cone_impacts
from igrip.geometry.frame_arrays import HandArrays, ObjectArrays
from igrip.geometry.packed_models import PackedModels, pack
from igrip.motion.trajectory import Motion
from igrip.objects.model import ObjectModel
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]
T = TypeVar("T")


class RayConfig(Settings):
    """Cones of rays from the predicted points, and the search for contact."""

    rays_per_cone: int = quantity(
        36,
        "1",
        "rays in a cone, its axis included",
        "guess; docs/benchmarks.md: what it costs",
        ge=1,
        le=1000,
    )
    slow_speed: float = quantity(0.03, "m/s", "at or below it the cone is widest", "guess", ge=0)
    slow_angle: float = quantity(
        math.radians(25.0), "rad", "half-angle at slow_speed", "guess", gt=0, lt=1.5
    )
    fast_speed: float = quantity(0.8, "m/s", "at or above it the cone is narrowest", "guess", gt=0)
    fast_angle: float = quantity(
        math.radians(8.0), "rad", "half-angle at fast_speed", "guess", gt=0, lt=1.5
    )
    min_speed: float = quantity(
        0.03, "m/s", "a slower predicted point has no direction, so no cone",
        "as cues.min_speed", ge=0,
    )  # fmt: skip
    contact_distance: float = quantity(
        0.08, "m", "palm to surface when a grasp closes", "guess", ge=0
    )
    contact_horizon: float = quantity(
        2.0, "s", "latest predicted contact", "the authors' code", gt=0
    )

    @model_validator(mode="after")
    def _ordered(self) -> RayConfig:
        if not self.slow_speed < self.fast_speed:
            raise ValueError("slow_speed must be less than fast_speed")
        return self


class PlacedObject(NamedTuple):
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
    path : (n, 4) or None
        Rows t, x, y, z of the mesh's origin lately, world frame [s, m]; None: it stands still.
    """

    id: str
    model: ObjectModel
    rotation: Array
    translation: Array
    centre: Array
    velocity: Array
    path: Array | None = None


class Geometry(NamedTuple):
    """One hand against every object, in the order of ``objects``. Arrays of shape (o,).

    Attributes
    ----------
    objects : sequence of PlacedObject
        The objects.
    hits : int64
        Rays of the cones that meet the mesh.
    vertex, future_vertex : float64
        To the nearest vertex, from the hand and from the barycentre of its predicted points [m].
    surface, future_surface : float64
        The same to the nearest surface point; measured when first read [m].
    centre, centre_rate : float64
        Distance to the centre of gravity and its time derivative [m, m/s].
    axial : float64
        z of the hand in the object frame [m].
    half_length : float64
        Half the length of the bounding cylinder [m].
    spread : float
        d_max: largest distance between two centres [m]; NaN for fewer than two objects.
    surfaces : function
        Measures ``surface`` and ``future_surface``, shape (2, o).
    cylinders : function
        Places the bounding cylinders (:class:`igrip.geometry.cylinder.Cylinders`).
    """

    objects: Sequence[PlacedObject]
    hits: NDArray[np.int64]
    vertex: Array
    future_vertex: Array
    centre: Array
    centre_rate: Array
    axial: Array
    half_length: Array
    spread: float
    surfaces: Callable[[], Array]
    cylinders: Callable[[], Cylinders]

    @property
    def surface(self) -> Array:
        """From the hand to the nearest surface point [m]."""
        surface: Array = self.surfaces()[0]
        return surface

    @property
    def future_surface(self) -> Array:
        """The same from the barycentre of its predicted points [m]."""
        ahead: Array = self.surfaces()[1]
        return ahead


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
        self._cones = Cones(
            ray_pattern(config.rays_per_cone), config.slow_speed, config.slow_angle,
            config.fast_speed, config.fast_angle, config.min_speed,
        )  # fmt: skip
        self._packed = pack({})
        self.counters = np.zeros(3, dtype=np.int64)

    def _pack_with(self, objects: Sequence[PlacedObject]) -> PackedModels:
        """Return the trees of all meshes known so far, those of these objects among them."""
        packed = self._packed
        missing = {
            o.model.name: o.model
            for o in objects if packed.models.get(o.model.name) is not o.model
        }  # fmt: skip
        if missing:
            packed = self._packed = pack({**packed.models, **missing})
        return packed

    def measure(self, hands: Sequence[Motion], objects: Sequence[PlacedObject]) -> list[Geometry]:
        """Measure every hand against every object; one :class:`Geometry` per hand."""
        count = len(objects)
        if not hands or not count:
            return [_nothing() for _ in hands]
        packed = self._pack_with(objects)
        models = packed.arrays
        placed = ObjectArrays(
            np.array([packed.number[o.model.name] for o in objects], dtype=np.int64),
            np.array([o.rotation for o in objects]), np.array([o.translation for o in objects]),
            np.array([o.centre for o in objects]), np.array([o.velocity for o in objects]),
        )  # fmt: skip
        moving = HandArrays(
            np.array([hand.position for hand in hands]),
            np.array([hand.velocity for hand in hands]),
            np.array([hand.future for hand in hands]),
            np.array([hand.future_velocity for hand in hands]),
        )
        measured = kernel.measure(models, placed, moving, self._cones, self.counters)

        def surfaces() -> Array:
            return kernel.surfaces(models, placed, moving, self.counters)

        def cylinders() -> Cylinders:
            out = Cylinders.zeros(count)
            place_cylinders(
                placed.models, models.axes, models.origins, models.sizes, placed.rotations,
                placed.translations, placed.velocities, out.rows,
            )  # fmt: skip
            paths = {k: o.path for k, o in enumerate(objects) if o.path is not None}
            return out._replace(paths=paths) if paths else out

        both, solids = _Once(surfaces), _Once(cylinders)
        half_length, spread = models.sizes[placed.models, 0], kernel.spread(placed.centres)
        return [
            Geometry(
                objects=objects,
                hits=measured.hits[h],
                vertex=measured.vertex[h],
                future_vertex=measured.future_vertex[h],
                centre=measured.centre[h],
                centre_rate=measured.centre_rate[h],
                axial=measured.axial[h],
                half_length=half_length,
                spread=spread,
                surfaces=lambda h=h: both()[:, h],  # type: ignore[misc]
                cylinders=solids,
            )
            for h in range(len(hands))
        ]

    def contact(self, hand: Motion, target: PlacedObject) -> tuple[float, Vector] | None:
        """Predict when the hand is within grasping distance of an object, and where it touches.

        Returns
        -------
        time, point : float, 3 floats
            Seconds from the hand's newest sample, and the nearest surface point then, world frame
            [m]. None: not within the horizon.
        """
        packed = self._pack_with([target])
        time, point = approach(
            packed.arrays, packed.number[target.model.name], target.rotation, target.translation,
            hand.coefficients, self._config.contact_distance, self._config.contact_horizon,
        )  # fmt: skip
        return None if math.isnan(time) else (time, point)

    def impacts(self, hand: Motion, target: PlacedObject) -> tuple[Array, Array]:
        """Cast the rays of one pair again, to be drawn.

        Returns
        -------
        directions : (f, r, 3)
            World frame; not unit vectors. NaN where a predicted point has no cone.
        lengths : (f, r)
            To the first impact in units of the direction; infinity for a miss.
        """
        packed = self._pack_with([target])
        rays: tuple[Array, Array] = cone_impacts(
            packed.arrays, packed.number[target.model.name], target.rotation, target.translation,
            hand.future, hand.future_velocity, self._cones,
        )  # fmt: skip
        return rays


class _Once(Generic[T]):
    """A result that is computed on first use; ``functools.cache`` takes longer to set up."""

    def __init__(self, compute: Callable[[], T]) -> None:
        self._compute = compute
        self._result: T | None = None

    def __call__(self) -> T:
        if self._result is None:
            self._result = self._compute()
        return self._result


def _nothing() -> Geometry:
    none, no_hits = np.empty(0), np.empty(0, dtype=np.int64)
    pair, cylinders = np.empty((2, 0)), Cylinders.zeros(0)
    return Geometry(
        [], no_hits, none, none, none, none, none, none, math.nan, lambda: pair, lambda: cylinders
    )
