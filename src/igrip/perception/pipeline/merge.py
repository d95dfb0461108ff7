"""Results of the stages become one stream of observations: time stamps and ticks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import msgspec

from igrip.entities import Hand, ObjectPose
from igrip.observation import Observation
from igrip.rgbd import Array, RgbdFrame


class DetectedHands(NamedTuple):
    """The hands of one frame.

    Attributes
    ----------
    hands : mapping of str to Hand or None
        By id; None: looked for, and not measured. World frame; ``t`` on the clock of the frames.
    landmarks : mapping of str to (21, 2) or (n, 2)
        Where those that were measured are in the picture [pixels].
    all_landmarks : sequence of (21, 2) or (n, 2)
        Of every hand that was detected, with an id or not: it covers what is behind it.
    """

    frame: RgbdFrame
    hands: Mapping[str, Hand | None]
    landmarks: Mapping[str, Array]
    all_landmarks: Sequence[Array] = ()


class DetectedObjects(NamedTuple):
    """The objects of one frame; poses as of :class:`igrip.perception.poses.PoseEstimator`."""

    frame: RgbdFrame
    poses: Mapping[str, ObjectPose | None]


Result = DetectedHands | DetectedObjects


class Merger:
    """Puts results on a clock that begins with the stream, at ``begin`` of that of the frames [s].

    It reads no clock itself.
    """

    def __init__(self, begin: float) -> None:
        self._begin = begin
        self._newest = 0.0

    def observation(self, result: Result, now: float) -> Observation:
        """Return a result as the message that arrives at ``now`` [s]."""
        t = self._stamp(now)
        if isinstance(result, DetectedHands):
            return Observation(t=t, hands=self._shifted(result.hands, result.frame.t))
        return Observation(t=t, objects=self._shifted(result.poses, result.frame.t))

    def tick(self, now: float) -> Observation:
        """Return the empty message of ``now`` [s]."""
        return Observation(t=self._stamp(now))

    def silence(self, now: float) -> float:
        """Return the time since the last message [s]."""
        return now - self._begin - self._newest

    def _stamp(self, now: float) -> float:
        self._newest = max(self._newest, now - self._begin)
        return self._newest

    def _shifted(self, entities: Mapping[str, Any], measured: float) -> dict[str, Any]:
        """Return entities with their times in the stream; without those measured before it."""
        shifted: dict[str, Any] = {}
        for id, entity in entities.items():
            t = measured if entity is None or entity.t is None else entity.t
            if t < self._begin:
                continue
            if entity is not None:
                entity = msgspec.structs.replace(entity, t=t - self._begin)
            shifted[id] = entity
        return shifted
