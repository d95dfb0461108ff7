"""One object over time: which model it has, where it is, and whether to believe it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.entities import ObjectPose
from igrip.errors import ObjectsError, UnknownModelError
from igrip.health import Gate, HealthConfig
from igrip.motion import rotation
from igrip.motion.filters import OneEuroConfig, OrientationFilter, PositionFilter
from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]


class ObjectConfig(Settings):
    """Filters of object poses."""

    position: OneEuroConfig = OneEuroConfig(min_cutoff=1.0, beta=5.0)
    orientation: OneEuroConfig = OneEuroConfig(min_cutoff=1.0, beta=1.0)
    still_speed: float = quantity(
        0.05, "m/s", "slower objects count as resting: less is jitter of the pose", "guess", ge=0
    )


class ObjectTrack:
    """Pose and health of one object.

    Attributes
    ----------
    id, model_name : str
        Its id in the messages, and the model it was bound to.
    model : ObjectModel or None
        None where the catalogue has no such model.
    reason : str or None
        Why it cannot be used, in words; None if it can.
    """

    def __init__(
        self, id: str, model_name: str, catalog: Catalog, config: ObjectConfig, health: HealthConfig
    ) -> None:
        self.id, self.model_name = id, model_name
        self._config = config
        self.gate = Gate(health, health.object_limit)
        self._static = False
        self._invalid: str | None = None
        self._late = False
        self.model: ObjectModel | None = None
        self._no_model: str | None = None
        try:
            self.model = catalog[model_name]
        except (UnknownModelError, ObjectsError) as error:
            self._no_model = str(error)
        self._reset()

    def _reset(self) -> None:
        self._position = PositionFilter(self._config.position)
        self._orientation = OrientationFilter(self._config.orientation)

    @property
    def reason(self) -> str | None:
        """Why the object cannot be used, in words; None if it can."""
        if self._no_model or self._invalid:
            return self._no_model or self._invalid
        if self._position.value is None:
            return "not seen yet"
        return "not seen for too long" if self._late else None

    @property
    def is_faulty(self) -> bool:
        """Whether something is wrong with its input, beyond not being seen."""
        return self._no_model is not None or self._invalid is not None

    def update(self, now: float, pose: ObjectPose) -> None:
        """Take a measurement that arrived at ``now`` [s]."""
        t = now if pose.t is None else pose.t
        verdict = self.gate.judge(now, t, pose.position)
        if verdict.action == "ignore":
            return
        self._invalid = verdict.reason
        if verdict.action == "refuse":
            return
        if verdict.action == "restart":
            self._reset()
        self._static = pose.static
        self._position.update(t, pose.position)
        self._orientation.update(t, pose.orientation)

    def advance(self, now: float) -> None:
        """Note that the time is ``now`` [s]."""
        self._late = not self._static and self.gate.is_late(now)

    @property
    def rotation(self) -> Array:
        """World-from-mesh rotation, shape (3, 3)."""
        return np.array(rotation.matrix(self._orientation.value or rotation.IDENTITY))

    @property
    def position(self) -> Array:
        """Origin of the mesh in the world, shape (3,) [m]."""
        return np.array(self._position.value)

    def centre_velocity(self, centre: Array) -> Array:
        """Velocity of a point of the object, world frame; zero for a resting object [m/s].

        Parameters
        ----------
        centre : (3,)
            The point, relative to the origin of the mesh, turned into the world frame [m].
        """
        v, w = self._position.derivative, self._orientation.derivative
        x, y, z = centre
        velocity = np.array(
            [v[0] + w[1] * z - w[2] * y, v[1] + w[2] * x - w[0] * z, v[2] + w[0] * y - w[1] * x]
        )
        if self._static or float(velocity @ velocity) < self._config.still_speed**2:
            return np.zeros(3)
        return velocity
