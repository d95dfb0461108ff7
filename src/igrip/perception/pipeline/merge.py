"""Stamps, orders and ticks: what the stages found becomes one stream of observations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from igrip.entities import Hand, ObjectPose
from igrip.observation import Observation
from igrip.rgbd import RgbdFrame

TICK = 0.05  # s of silence after which the estimator is told that time passes (DESIGN §3)


class HandsFound(NamedTuple):
    """The hands of one frame.

    Attributes
    ----------
    frame : RgbdFrame
        The frame.
    hands : mapping of str to Hand or None
        By id; None: looked for, and not measured. World frame; ``t`` on the clock of the frames.
    landmarks : mapping of str to (21, 2)
        Where those that were measured are in the picture [pixels].
    seen : sequence of (21, 2)
        All that were seen, measured and named or not: they cover what is behind them.
    """

    frame: RgbdFrame
    hands: Mapping[str, Hand | None]
    landmarks: Mapping[str, NDArray[np.float64]]
    seen: Sequence[NDArray[np.float64]] = ()


class ObjectsFound(NamedTuple):
    """The objects of one frame; poses as of :class:`igrip.perception.poses.PoseEstimator`."""

    frame: RgbdFrame
    poses: Mapping[str, ObjectPose | None]


class Merge:
    """Puts results on one clock that begins with the stream. Knows no thread, and no other time.

    Parameters
    ----------
    begin : float
        When the stream begins, on the clock of the frames [s].
    """

    def __init__(self, begin: float) -> None:
        self._begin = begin
        self._newest = 0.0

    def take(self, found: HandsFound | ObjectsFound, now: float) -> Observation:
        """Return what was found as the message that arrives at ``now`` [s]."""
        t = self._stamp(now)
        if isinstance(found, HandsFound):
            return Observation(t=t, hands=self._moved(found.hands, found.frame.t))
        return Observation(t=t, objects=self._moved(found.poses, found.frame.t))

    def tick(self, now: float) -> Observation:
        """Return the message that says that time has passed."""
        return Observation(t=self._stamp(now))

    def silent(self, now: float) -> float:
        """Return for how long nothing was said [s]."""
        return now - self._begin - self._newest

    def _stamp(self, now: float) -> float:
        self._newest = max(self._newest, now - self._begin)
        return self._newest

    def _moved(self, entities: Mapping[str, Any], measured: float) -> dict[str, Any]:
        """Return entities with their times in the stream; without those measured before it."""
        moved: dict[str, Any] = {}
        for id, entity in entities.items():
            own = measured if entity is None or entity.t is None else entity.t
            if own >= self._begin:
                moved[id] = None if entity is None else msgspec.structs.replace(
                    entity, t=own - self._begin
                )  # fmt: skip
        return moved
