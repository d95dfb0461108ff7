"""Tracker: follows hands and objects, each with its own gate and filters."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Container
from typing import Any, TypeVar

from igrip.entities import ObjectPose
from igrip.errors import ObservationError
from igrip.gating import GatingConfig, find_coincident
from igrip.geometry.scene import PlacedObject
from igrip.motion.hand_track import HandTrack
from igrip.motion.trajectory import MotionConfig
from igrip.objects.catalog import Catalog
from igrip.objects.object_track import ObjectConfig, ObjectTrack
from igrip.observation import Observation
from igrip.settings import Settings, quantity

Track = TypeVar("Track", HandTrack, ObjectTrack)


class TrackingConfig(Settings):
    """How many hands and objects are followed, whatever a source sends."""

    max_hands: int = quantity(16, "1", "hands followed at the same time", "guess", ge=1)
    max_objects: int = quantity(256, "1", "objects followed at the same time", "guess", ge=1)


class Tracker:
    """Tracks of all hands and objects.

    Attributes
    ----------
    t : float
        Time of the newest message [s].
    hands, objects : dict
        The tracks by id.
    counts : Counter
        Number of ``messages``, ``unknown_fields``, and of tracks that found no room (``too_many``).
    """

    def __init__(
        self,
        catalog: Catalog,
        config: TrackingConfig,
        motion: MotionConfig,
        objects: ObjectConfig,
        gating: GatingConfig,
    ) -> None:
        self._catalog, self._config = catalog, config
        self._motion_config, self._object_config, self._gating = motion, objects, gating
        self.t = 0.0
        self.hands: dict[str, HandTrack] = {}
        self.objects: dict[str, ObjectTrack] = {}
        self.counts: Counter[str] = Counter()
        self._dropped = 0
        self._placed: dict[str, PlacedObject] = {}  # poses that have not changed since

    def update(self, observation: Observation) -> list[HandTrack]:
        """Update all tracks with a message: objects first, then hands.

        Returns
        -------
        list of HandTrack
            The hands that were measured in it, by id.

        Raises
        ------
        ObservationError
            If time decreases, an id is bound to another model, or a new id names no model; nothing
            has changed then.
        """
        self._check(observation)
        self.t = now = observation.t
        self.counts["messages"] += 1
        if observation.hands.keys() - self.hands or observation.objects.keys() - self.objects:
            self._advance(now)  # room is made by forgetting stale tracks
        self.counts["unknown_fields"] += observation.unknown_fields
        if observation.invalid is None:
            self._update_objects(observation)
        measured = []
        for id, hand in sorted(observation.hands.items()):
            if hand is None:
                if id in self.hands:
                    self.hands[id].miss(observation.not_seen.get(f"hands.{id}"))
                continue
            track = self._hand(id, observation)
            if track is None:
                continue
            if observation.invalid is not None:
                track.reject(now, observation.invalid)
                measured.append(track)
            elif track.update(now, hand):
                measured.append(track)
        self._find_coincident_hands(measured)
        self._advance(now)
        return measured

    def _find_coincident_hands(self, measured: list[HandTrack]) -> None:
        """Mark hands at the same place: one of them is a false detection."""
        if not measured or len(self.hands) < 2:
            return  # a marked hand keeps its mark: its other is not forgotten without a new hand
        positions = {
            id: hand.gate.position
            for id, hand in self.hands.items() if hand.gate.position and hand.is_steady(self.t)
        }  # fmt: skip
        same = find_coincident(positions, self._gating.min_hand_separation)
        for id, hand in self.hands.items():
            hand.same_as = same.get(id)

    def _advance(self, now: float) -> None:
        for object_track in self.objects.values():
            object_track.advance(now)
        for hand_track in self.hands.values():
            hand_track.advance(now)

    def _update_objects(self, observation: Observation) -> None:
        dropped = 0
        # a mesh that changes while a hand reaches for it would make distances jump
        calm = all(hand.status != "reaching" for hand in self.hands.values())
        # by id: which objects find room must not depend on their order in the message
        for id, pose in sorted(observation.objects.items()):
            if pose is None:
                if id in self.objects:
                    self.objects[id].miss(observation.t, observation.not_seen.get(f"objects.{id}"))
                continue
            track = self._object(id, pose, observation)
            if track is None:
                dropped += 1
                continue
            if calm and track.model is not None:
                track.renew_model()
            track.update(observation.t, pose)
            self._placed.pop(id, None)
        if observation.objects:
            self._dropped = dropped

    def placed_objects(self) -> list[PlacedObject]:
        """Return the objects that can be used now, with their filtered poses."""
        usable = [track for track in self.objects.values() if track.reason is None]
        for track in usable:
            if track.id not in self._placed and track.model is not None:
                pose = track.place(track.model.centre)
                self._placed[track.id] = PlacedObject(track.id, track.model, *pose, track.path)
        return [self._placed[track.id] for track in usable]

    def trusts(self, id: str) -> bool:
        """Return whether a device may act on an object: no fault, and no other at its place."""
        track = self.objects.get(id)
        if track is None or not track.trusted or track.gate.position is None:
            return False
        place, min_separation = track.gate.position, self._gating.min_object_separation
        return not any(
            other is not track and other.gate.position is not None
            and math.dist(place, other.gate.position) < min_separation and other.trusted
            for other in self.objects.values()
        )  # fmt: skip

    def object_problems(self) -> str | None:
        """Return what is wrong with the input of objects, as text; None if nothing is."""
        usable = any(track.reason is None for track in self.objects.values())
        faulty = [t for t in self.objects.values() if t.fault or (not usable and t.reason)]
        parts = [f"{track.id}: {track.fault or track.reason}" for track in faulty[:3]]
        if len(faulty) > 3:
            parts.append(f"and {len(faulty) - 3} more")
        if self._dropped:
            limit = self._config.max_objects
            parts.append(f"{self._dropped} objects beyond the limit of {limit} are left out")
        if not usable:
            parts.insert(0, "no usable object")
        return "; ".join(parts) or None

    def summary(self) -> dict[str, Any]:
        """Return status, reason, age and counts of every hand and object, as plain data."""
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
            track = ObjectTrack(id, pose.model, self._catalog, self._object_config, self._gating)
            self.objects[id] = track
        return track

    def _hand(self, id: str, message: Observation) -> HandTrack | None:
        track = self.hands.get(id)
        if track is None and self._make_room(self.hands, self._config.max_hands, message.hands):
            track = self.hands[id] = HandTrack(id, self._motion_config, self._gating)
        return track

    def _make_room(self, tracks: dict[str, Track], limit: int, named: Container[str]) -> bool:
        """Return whether there is room for a track; forget the oldest stale one if need be.

        A track that the present message names is not forgotten.
        """
        if len(tracks) < limit:
            return True
        stale = [track for track in tracks.values() if track.is_stale and track.id not in named]
        if not stale:
            self.counts["too_many"] += 1
            return False
        oldest = min(stale, key=_newest).id
        del tracks[oldest]
        self._placed.pop(oldest, None)
        return True


class TrustedObjects:
    """The objects that a device may act on after the newest message."""

    def __init__(self, tracker: Tracker) -> None:
        self._tracker = tracker

    def __contains__(self, id: object) -> bool:
        return isinstance(id, str) and self._tracker.trusts(id)


def _newest(track: HandTrack | ObjectTrack) -> float:
    newest = track.gate.newest
    return -1.0 if math.isnan(newest) else newest  # never accepted: the first to go


def _age(now: float, track: HandTrack | ObjectTrack) -> float | None:
    newest = track.gate.newest
    return None if math.isnan(newest) else now - newest
