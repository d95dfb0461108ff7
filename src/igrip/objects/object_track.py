"""One object over time: its model, its pose, and whether it may be used."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from igrip.entities import ObjectPose, Vector
from igrip.errors import ObjectsError, UnknownModelError
from igrip.gating import Gate, GatingConfig
from igrip.motion.filters import OneEuroConfig, PlacedPoint, PoseFilter
from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]


PATH_SPAN, PATH_STEP = 2.5, 0.03  # s; how much of an object's path is kept, and how finely; guesses
MAX_MISS_DELAY = 0.15  # s; a detection that found nothing is no older, however late poses arrive


class ObjectConfig(Settings):
    """Filters of object poses."""

    position: OneEuroConfig = OneEuroConfig(min_cutoff=1.0, beta=5.0)
    orientation: OneEuroConfig = OneEuroConfig(min_cutoff=1.0, beta=1.0)
    rest_speed: float = quantity(
        0.05, "m/s", "a slower object rests: its speed is jitter of the pose", "guess", ge=0
    )
    rest_distance: float = quantity(
        0.03, "m", "an object that has kept within this distance for 2.5 s stands still: the reach "
        "for it is not seen from it", "guess: jitter of a pose is half as large", ge=0,
    )  # fmt: skip


class ObjectTrack:
    """Gate, pose filter and model of one object.

    Attributes
    ----------
    id, model_name : str
        Its id in the messages, and the model it is bound to.
    model : ObjectModel or None
        None if the catalogue has no such model.
    gate : Gate
        Decides which measurements are accepted.
    """

    def __init__(
        self, id: str, model_name: str, catalog: Catalog, config: ObjectConfig, gating: GatingConfig
    ) -> None:
        self.id, self.model_name = id, model_name
        self._config = config
        self.gate = Gate(gating, gating.max_object_age)
        self._max_age = gating.max_object_age
        self._static = False
        self._rejection: str | None = None
        self._stale = False
        self._delay = 0.0  # age of its poses on arrival
        self._missed_at = -math.inf
        self._not_seen: str | None = None
        self._static_until = -math.inf
        self.model: ObjectModel | None = None
        self._no_model: str | None = None
        self._catalog = catalog
        self.renew_model()
        self._reset()

    def renew_model(self) -> None:
        """Take the catalogue's present model: that of a thing first seen may have been refined."""
        try:
            self.model, self._no_model = self._catalog[self.model_name], None
        except (UnknownModelError, ObjectsError, OSError) as error:
            self._no_model = str(error)

    def _reset(self) -> None:
        self._filter = PoseFilter(self._config.position, self._config.orientation)
        self._path: deque[tuple[float, float, float, float]] = deque()
        self._bounds: tuple[Vector, Vector] | None = None  # hold the path, and maybe more

    @property
    def reason(self) -> str | None:
        """Why the object cannot be used, as text; None if it can."""
        if self._no_model is not None:
            return self._no_model
        if not self._filter.begun:
            return self._rejection or "not detected yet"
        if not self._stale:
            return None
        why = f": {self._not_seen}" if self._not_seen else ""
        return self._rejection or f"not detected for too long{why}"

    @property
    def fault(self) -> str | None:
        """What is wrong with its input, as text, even if its last good pose is still used."""
        return self._no_model or self._rejection

    @property
    def trusted(self) -> bool:
        """Whether a device may act on it: detected when last looked for, without any fault."""
        missed = self._missed_at >= self.gate.newest
        stepped = self.gate.offset != 0.0
        return not missed and self.reason is None and self.fault is None and not stepped

    @property
    def is_stale(self) -> bool:
        """Whether it was not measured for longer than ``max_object_age``, and is not static."""
        return self._stale

    def update(self, now: float, pose: ObjectPose) -> None:
        """Add a measurement that arrived at ``now`` [s]; a rejected one changes no pose."""
        t = now if pose.t is None else pose.t
        verdict = self.gate.check(now, t, pose.position)
        if verdict.action == "ignore":
            return
        self._not_seen = None
        self._rejection = verdict.reason
        if verdict.action == "reject":
            return
        if verdict.action == "restart":
            self._reset()
        self._static = pose.static
        self._delay = min(max(0.0, now - self.gate.newest), MAX_MISS_DELAY)
        self._filter.update(self.gate.newest, pose.position, pose.orientation)
        self._keep(self.gate.newest, pose.position)

    def _keep(self, t: float, position: Vector) -> None:
        """Add a place to the path, unless it is as good as the last."""
        path = self._path
        if len(path) > 1 and t - path[-2][0] < PATH_STEP:
            path.pop()
        path.append((t, *position))
        while t - path[0][0] > PATH_SPAN:
            path.popleft()
        x, y, z = position
        (a, b, c), (d, e, f) = self._bounds or (position, position)
        self._bounds = (min(a, x), min(b, y), min(c, z)), (max(d, x), max(e, y), max(f, z))

    @property
    def path(self) -> Array | None:
        """Rows t, x, y, z of the mesh's origin over the last 2.5 s, (n, 4) [s, m], world frame.

        None for an object that stands still.
        """
        if self._static or not self._extends():
            return None
        path = np.array(self._path)
        low, high = path[:, 1:].min(axis=0).tolist(), path[:, 1:].max(axis=0).tolist()
        self._bounds = tuple(low), tuple(high)  # no longer of places that are forgotten since
        return path if self._extends() else None

    def _extends(self) -> bool:
        """Whether the bounds are wider than an object that stands still is seen to move."""
        if self._bounds is None:
            return False
        (a, b, c), (d, e, f) = self._bounds
        return max(d - a, e - b, f - c) > self._config.rest_distance

    def miss(self, now: float, reason: str | None = None) -> None:
        """Note that the object was looked for and not detected, and why, if that is known.

        A static one begins to age.
        """
        self._not_seen = reason
        self.gate.counts["missed"] += 1
        # a detection that found nothing is as old as one that found something
        self._missed_at = now - self._delay
        if self._static:
            self._static, self._static_until = False, now

    def advance(self, now: float) -> None:
        """Set the time to ``now`` [s]."""
        age = now - max(self.gate.newest, self._static_until)
        self._stale = not self._static and not age <= self._max_age

    def place(self, point: Array) -> PlacedPoint:
        """Return the filtered pose, with a point of the object and its velocity.

        Parameters
        ----------
        point : (3,)
            In the frame of the mesh [m].
        """
        return self._filter.place(point, math.inf if self._static else self._config.rest_speed)
