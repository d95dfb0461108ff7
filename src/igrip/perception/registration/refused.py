"""What was searched in vain: it is searched again ever more seldom while it looks the same."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from igrip.perception.registration.clusters import Cluster
from igrip.rgbd import Array

SAME_PLACE, SAME_TOP = 0.008, 0.010  # how far apart the middles and tops of one cluster may be [m]
SAME_SIZE = 0.12  # and by which share its number of points may differ; guess
FIRST, LONGEST = 1.0, 16.0  # until a cluster is searched again [s]; twice as long each time; guess
FORGOTTEN = 40.0  # s after which what was not seen again is forgotten


@dataclass
class _Refused:
    middle: Array  # (3,) [m]
    count: int
    top: float  # [m]
    until: dict[str, tuple[float, float]]  # by id: when it may be tried again, and the wait [s]
    t: float  # [s]

    def is_same(self, cluster: Cluster) -> bool:
        away = np.linalg.norm(cluster.points.mean(axis=0) - self.middle)
        alike = abs(len(cluster.points) - self.count) <= SAME_SIZE * self.count
        return bool(away < SAME_PLACE and alike and abs(cluster.top - self.top) < SAME_TOP)


class Refusals:
    """Clusters on which some models were tried in vain, before one camera."""

    def __init__(self) -> None:
        self._clusters: list[_Refused] = []

    def allowed(self, cluster: Cluster, ids: Iterable[str], t: float) -> set[str]:
        """Return which of some ids are worth a try on a cluster at a time [s]."""
        known = self._find(cluster, t)
        if known is None:
            return set(ids)
        known.t = t
        return {id for id in ids if t >= known.until.get(id, (-np.inf, 0.0))[0]}

    def add(self, cluster: Cluster, ids: Iterable[str], t: float) -> None:
        """Take down that some ids were tried on a cluster in vain."""
        known = self._find(cluster, t)
        if known is None:
            middle = cluster.points.mean(axis=0)
            known = _Refused(middle, len(cluster.points), cluster.top, {}, t)
            self._clusters.append(known)
        for id in ids:
            wait = min(LONGEST, 2.0 * known.until.get(id, (0.0, 0.5 * FIRST))[1])
            known.until[id] = t + wait, wait

    def clear(self) -> None:
        """Forget all."""
        self._clusters.clear()

    def _find(self, cluster: Cluster, t: float) -> _Refused | None:
        self._clusters = [one for one in self._clusters if 0.0 <= t - one.t < FORGOTTEN]
        return next((one for one in self._clusters if one.is_same(cluster)), None)
