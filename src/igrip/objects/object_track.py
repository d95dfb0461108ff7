"""One object over time: which model it has, where it is, and whether to believe it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.entities import ObjectPose
from igrip.errors import ObjectsError, UnknownModelError
from igrip.gating import Gate, GatingConfig
from igrip.motion import one_euro_kernel as low_pass
from igrip.motion.filters import OneEuroConfig, PoseFilter
from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]


USUAL_DELAY = 0.15  # s; a look that found nothing is no older than that, however late poses come


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
        self, id: str, model_name: str, catalog: Catalog, config: ObjectConfig, health: GatingConfig
    ) -> None:
        self.id, self.model_name = id, model_name
        self._config = config
        self.gate = Gate(health, health.object_limit)
        self._limit = health.object_limit
        self._static = False
        self._refusal: str | None = None
        self._late = False
        self._delay = 0.0  # how old its poses are when they come
        self._missed_at = -math.inf
        self._static_until = -math.inf
        self.model: ObjectModel | None = None
        self._no_model: str | None = None
        try:
            self.model = catalog[model_name]
        except (UnknownModelError, ObjectsError, OSError) as error:
            self._no_model = str(error)
        self._reset()

    def _reset(self) -> None:
        self._filter = PoseFilter(self._config.position, self._config.orientation)

    @property
    def reason(self) -> str | None:
        """Why the object cannot be used, in words; None if it can."""
        if self._no_model is not None:
            return self._no_model
        if not self._filter.position.begun:
            return self._refusal or "not seen yet"
        return self._refusal or "not seen for too long" if self._late else None

    @property
    def fault(self) -> str | None:
        """What is wrong with its input, in words, even where its last good pose is still used."""
        return self._no_model or self._refusal

    @property
    def trusted(self) -> bool:
        """Whether it was seen when last looked for, and nothing speaks against what was seen."""
        missed = self._missed_at >= self.gate.newest
        return not missed and self.reason is None and self.fault is None and not self._stepped

    @property
    def _stepped(self) -> bool:
        return self.gate.offset != 0.0

    @property
    def is_late(self) -> bool:
        """Whether it has not been measured for too long, and is not static."""
        return self._late

    def update(self, now: float, pose: ObjectPose) -> None:
        """Take a measurement that arrived at ``now`` [s]; one that is refused changes no pose."""
        t = now if pose.t is None else pose.t
        verdict = self.gate.judge(now, t, pose.position)
        if verdict.action == "ignore":
            return
        self._refusal = verdict.reason
        if verdict.action == "refuse":
            return
        if verdict.action == "restart":
            self._reset()
        self._static = pose.static
        self._delay = min(max(0.0, now - self.gate.newest), USUAL_DELAY)
        self._filter.update(self.gate.newest, pose.position, pose.orientation)

    def miss(self, now: float) -> None:
        """Note that the object was looked for and not seen: a static one begins to age."""
        self.gate.counts["missed"] += 1
        # a look that found nothing is as old as one that found something
        self._missed_at = now - self._delay
        if self._static:
            self._static, self._static_until = False, now

    def advance(self, now: float) -> None:
        """Note that the time is ``now`` [s]."""
        aged = now - max(self.gate.newest, self._static_until)
        self._late = not self._static and not aged <= self._limit

    def place(self, point: Array) -> Array:
        """Return the filtered pose, and where a point of the object is and moves to.

        Parameters
        ----------
        point : (3,)
            In the frame of the mesh [m].

        Returns
        -------
        (6, 3)
            World-from-mesh rotation by rows, translation [m], the point in the world [m], and its
            velocity [m/s], zero for a resting object.
        """
        out = np.empty((6, 3))
        still = math.inf if self._static else self._config.still_speed
        kept = self._filter
        low_pass.place(kept.position.state, kept.orientation.state, point, still, out)
        return out
