"""The hands and objects that are known, each with its own filters, age and health."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Container
from typing import Any, TypeVar

from igrip.entities import ObjectPose
from igrip.errors import ObservationError
from igrip.gating import GatingConfig, contradictions
from igrip.geometry.scene import PlacedObject
from igrip.motion.hand_track import HandTrack
from igrip.motion.trajectory import MotionConfig
from igrip.objects.catalog import Catalog
from igrip.objects.object_track import ObjectConfig, ObjectTrack
from igrip.observation import Observation
from igrip.settings import Settings, quantity

Track = TypeVar("Track", HandTrack, ObjectTrack)


class TrackingConfig(Settings):
    """How much is remembered, whatever a source sends."""

    max_hands: int = quantity(16, "1", "hands followed at a time", "guess", ge=1)
    max_objects: int = quantity(256, "1", "objects followed at a time", "guess", ge=1)


class Tracker:
    """All tracks. :meth:`take` either takes a whole message or raises and changes nothing."""

    def __init__(
        self,
        catalog: Catalog,
        config: TrackingConfig,
        motion: MotionConfig,
        objects: ObjectConfig,
        health: GatingConfig,
    ) -> None:
        self._catalog, self._config = catalog, config
        self._motion_config, self._object_config, self._health = motion, objects, health
        self.t = 0.0
        self.hands: dict[str, HandTrack] = {}
        self.objects: dict[str, ObjectTrack] = {}
        self.counts: Counter[str] = Counter()
        self._left_out = 0
        self._placed: dict[
            str, PlacedObject
        ] = {}  # poses that have not changed since they were placed

    def take(self, observation: Observation) -> list[HandTrack]:
        """Take a message: objects first, then hands.

        Returns
        -------
        list of HandTrack
            The hands that were measured in it, by id.

        Raises
        ------
        ObservationError
            If time decreases, an id is bound to another model, or a new id names no model.
        """
        self._check(observation)
        self.t = now = observation.t
        self.counts["messages"] += 1
        if observation.hands.keys() - self.hands or observation.objects.keys() - self.objects:
            self._advance(now)  # who is lost must be known before room is made
        self.counts["unknown_fields"] += observation.unknown_fields
        self._take_objects(observation)
        measured = []
        for id, hand in sorted(observation.hands.items()):
            if hand is None or (track := self._hand(id, observation)) is None:
                continue
            if track.update(now, hand):
                measured.append(track)
        self._compare(measured)
        self._advance(now)
        return measured

    def _compare(self, measured: list[HandTrack]) -> None:
        """Note which hands are where another is: one of them is not there."""
        if not measured or len(self.hands) < 2:
            return  # a hand that had another beside it still has: none is forgotten without one
        seen = {
            id: hand.gate.position
            for id, hand in self.hands.items() if hand.gate.position and hand.is_steady(self.t)
        }  # fmt: skip
        same = contradictions(seen, self._health.hands_apart)
        for id, hand in self.hands.items():
            hand.same_as = same.get(id)

    def _advance(self, now: float) -> None:
        for object_track in self.objects.values():
            object_track.advance(now)
        for hand_track in self.hands.values():
            hand_track.advance(now)

    def _take_objects(self, observation: Observation) -> None:
        left_out = 0
        # by id: which objects there is room for must not hang on their order in the message
        for id, pose in sorted(observation.objects.items()):
            if pose is None:
                if id in self.objects:
                    self.objects[id].miss(observation.t)
                continue
            track = self._object(id, pose, observation)
            if track is None:
                left_out += 1
                continue
            track.update(observation.t, pose)
            self._placed.pop(id, None)
        if observation.objects:
            self._left_out = left_out

    def placed(self) -> list[PlacedObject]:
        """Return the objects that can be used now, with their poses."""
        usable = [track for track in self.objects.values() if track.reason is None]
        for track in usable:
            if track.id not in self._placed and track.model is not None:
                pose = track.place(track.model.centre)
                self._placed[track.id] = PlacedObject(track.id, track.model, pose[:3], *pose[3:])
        return [self._placed[track.id] for track in usable]

    def trusts(self, id: str) -> bool:
        """Whether a device may act on an object: seen when last looked for, and believed."""
        track = self.objects.get(id)
        if track is None or not track.trusted or track.gate.position is None:
            return False
        place, apart = track.gate.position, self._health.objects_apart
        return not any(
            other is not track and other.gate.position is not None
            and math.dist(place, other.gate.position) < apart and other.trusted
            for other in self.objects.values()
        )  # fmt: skip

    def trouble(self) -> str | None:
        """Say what is wrong with the input of objects, in words."""
        usable = any(track.reason is None for track in self.objects.values())
        named = [t for t in self.objects.values() if t.fault or (not usable and t.reason)]
        parts = [f"{track.id}: {track.fault or track.reason}" for track in named[:3]]
        if len(named) > 3:
            parts.append(f"and {len(named) - 3} more")
        if self._left_out:
            most = self._config.max_objects
            parts.append(f"{self._left_out} objects beyond the limit of {most} are left out")
        if not usable:
            parts.insert(0, "no usable object")
        return "; ".join(parts) or None

    def report(self) -> dict[str, Any]:
        """Return status, reason, age and counts of every input, as plain data."""
        return {
            "t": self.t,
            "counts": dict(self.counts),
            "hands": {
                id: {
                    "status": track.status,
                    "reason": track.reason(self.t),
                    "age": _age(self.t, track),
                    "counts": dict(track.gate.counts),
                }
                for id, track in self.hands.items()
            },
            "objects": {
                id: {
                    "model": track.model_name,
                    "known": track.model is not None,
                    "usable": track.reason is None,
                    "reason": track.reason or track.fault,
                    "age": _age(self.t, track),
                    "counts": dict(track.gate.counts),
                }
                for id, track in self.objects.items()
            },
        }

    def _check(self, observation: Observation) -> None:
        if observation.t < self.t:
            raise ObservationError("t", f"decreased from {self.t!r} to {observation.t!r}")
        for id, pose in observation.objects.items():
            if pose is None:
                continue
            track = self.objects.get(id)
            if track is None:
                if pose.model is None:
                    raise ObservationError(
                        f"objects.{id:.80}.model", "is needed when an object first appears", id
                    )
            elif pose.model not in (None, track.model_name):
                raise ObservationError(
                    f"objects.{id:.80}.model",
                    f"is {pose.model!r:.80}, but the id is bound to {track.model_name!r:.80}",
                    id,
                )

    def _object(self, id: str, pose: ObjectPose, message: Observation) -> ObjectTrack | None:
        track = self.objects.get(id)
        room = track is None and self._make_room(
            self.objects, self._config.max_objects, message.objects
        )
        if room and pose.model is not None:
            track = ObjectTrack(id, pose.model, self._catalog, self._object_config, self._health)
            self.objects[id] = track
        return track

    def _hand(self, id: str, message: Observation) -> HandTrack | None:
        track = self.hands.get(id)
        if track is None and self._make_room(self.hands, self._config.max_hands, message.hands):
            track = self.hands[id] = HandTrack(id, self._motion_config, self._health)
        return track

    def _make_room(self, tracks: dict[str, Track], most: int, named: Container[str]) -> bool:
        """Forget the track that has been lost for longest, if need be and if there is one.

        What the present message names is not forgotten, whatever its age.
        """
        if len(tracks) < most:
            return True
        lost = [track for track in tracks.values() if track.is_late and track.id not in named]
        if not lost:
            self.counts["too_many"] += 1
            return False
        forgotten = min(lost, key=_newest).id
        del tracks[forgotten]
        self._placed.pop(forgotten, None)
        return True


class TrustedObjects:
    """The objects that a device may act on after the newest message."""

    def __init__(self, world: Tracker) -> None:
        self._world = world

    def __contains__(self, id: object) -> bool:
        return isinstance(id, str) and self._world.trusts(id)


def _newest(track: HandTrack | ObjectTrack) -> float:
    newest = track.gate.newest
    return -1.0 if math.isnan(newest) else newest  # never believed: the first to go


def _age(now: float, track: HandTrack | ObjectTrack) -> float | None:
    newest = track.gate.newest
    return None if math.isnan(newest) else now - newest
