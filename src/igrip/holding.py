"""Which hand holds which object, by what is seen: a held object moves along with its hand.

An object is taken to be held by a hand from when both have made the same way, near each other, at
two of its poses in a row. It stays held, at rest too, until the hand is seen away from it. A hand
that is not seen keeps what it holds until the object has stood still for as long as its path is
remembered. A hand that rests at an object which nobody has moved is not known to hold it: it may
steady it, or merely lie there.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import PlacedObject
from igrip.motion.trajectory import Motion
from igrip.targets import HandEstimate

Array = NDArray[np.float64]
WINDOW = 0.4  # s; ways are those over this time; guess
MIN_WAY = 0.04  # m; a shorter way of an object says nothing, its pose jitters; guess
MIN_COSINE = 0.8  # between the ways of a hand and of what it holds; guess
MAX_RATIO = 3.0  # of their lengths: poses of objects are late; guess
LATE = 0.12  # s; an object is seen behind its hand by its way in this time, at most; guess
STILL_WAY = 0.02  # m; an object with a shorter way in the window is still; guess
TOGETHER = 0.3  # s; hands that began to hold an object within this hold it together; guess
MIN_AWAY = 0.2  # s; poses of symmetric objects flip now and then, which moves them; guess
MEMORY = 1.0  # s; of the places of a hand


@dataclass
class _Hold:
    """One hand with one object."""

    since: float  # when it was first seen to move along [s]
    seen_at: float  # time of the newest pose of the object that was judged [s]
    confirmed: bool = False
    offset: Array | None = None  # of the palm from the still object, (3,) [m]
    away_since: float = math.nan  # from when on the palm is elsewhere beside it [s]


@dataclass
class _Trace:
    """Where a hand was lately."""

    times: deque[float] = field(default_factory=deque)
    places: deque[Array] = field(default_factory=deque)

    def add(self, t: float, place: Array) -> None:
        """Add a place, (3,) [m], at a time [s] later than the last."""
        if self.times and t <= self.times[-1]:
            return
        self.times.append(t)
        self.places.append(place)
        while t - self.times[0] > MEMORY:
            self.times.popleft()
            self.places.popleft()

    def way(self, begin: float, end: float) -> Array | None:
        """Return its way between two times [s], (3,) [m]; None if they are not all remembered."""
        if len(self.times) < 2 or self.times[0] > begin + 0.1:
            return None
        return _at(self.times, self.places, end) - _at(self.times, self.places, begin)


class Holding:
    """Follows which hands hold which objects.

    Parameters
    ----------
    holding_distance : float
        A palm this near to a surface may hold the object [m].
    release_margin : float
        A palm that is this much further away, or has moved this far from a still object, has
        released it [m].
    """

    def __init__(self, holding_distance: float, release_margin: float) -> None:
        self._near, self._margin = holding_distance, release_margin
        self._traces: dict[str, _Trace] = {}
        self._holds: dict[tuple[str, str], _Hold] = {}

    def update(
        self,
        hands: Sequence[HandEstimate],
        known: Collection[str],
        followed: Collection[str],
    ) -> None:
        """Add a frame.

        Parameters
        ----------
        hands : sequence of HandEstimate
            The hands that are seen in this frame.
        known, followed : collection of str
            Ids of all hands that are known, and of those that were seen lately.
        """
        if len(known) < 2:
            self._traces.clear()
            self._holds.clear()
            return
        for gone in self._traces.keys() - set(known):
            del self._traces[gone]
        for hand in hands:
            self._traces.setdefault(hand.id, _Trace()).add(hand.motion.t, hand.motion.position)
        objects = hands[0].geometry.objects if hands else ()
        moved = [(o, placed) for o, placed in enumerate(objects) if placed.path is not None]
        if self._holds:
            still = {placed.id for placed in objects} - {placed.id for _, placed in moved}
            for id, object in list(self._holds):
                if object in still and id not in followed:
                    del self._holds[id, object]
            self._release(hands)
        for o, placed in moved:
            for hand in hands:
                self._begin(hand.id, placed, float(hand.geometry.vertex[o]))

    def by_others(self, hand: str) -> Mapping[str, str]:
        """Return what this hand must not take: by object, the hand that held it before."""
        held: dict[str, str] = {}
        if not self._holds:
            return held
        for (other, object), hold in self._holds.items():
            if other == hand or not hold.confirmed:
                continue
            own = self._holds.get((hand, object))
            together = own is not None and own.confirmed and own.since <= hold.since + TOGETHER
            if not together:
                held[object] = other
        return held

    def _begin(self, hand: str, placed: PlacedObject, distance: float) -> None:
        """Judge whether an object moves along with a hand, once for each of its poses."""
        path = placed.path
        assert path is not None
        known = self._holds.get((hand, placed.id))
        end = float(path[-1, 0])
        if known is not None and (known.confirmed or known.seen_at >= end):
            return
        way = _way(path)
        speed = float(np.linalg.norm(way)) / WINDOW
        along = distance <= self._near + LATE * speed and self._is_along(hand, path, way)
        if not along:
            self._holds.pop((hand, placed.id), None)
        elif known is None:
            self._holds[hand, placed.id] = _Hold(since=end, seen_at=end)
        else:
            known.seen_at, known.confirmed = end, True

    def _is_along(self, hand: str, path: Array, way: Array) -> bool:
        own = self._way_of(hand, path)
        length = float(np.linalg.norm(way))
        if own is None or length < MIN_WAY:
            return False
        reach = float(np.linalg.norm(own))
        alike = length / MAX_RATIO <= reach <= length * MAX_RATIO
        return alike and float(own @ way) >= MIN_COSINE * reach * length

    def _way_of(self, hand: str, path: Array) -> Array | None:
        end = float(path[-1, 0])
        return self._traces[hand].way(end - WINDOW, end)

    def _release(self, hands: Sequence[HandEstimate]) -> None:
        """End the holds of hands that are seen away from what they held."""
        for hand in hands:
            for o, placed in enumerate(hand.geometry.objects):
                hold = self._holds.get((hand.id, placed.id))
                if hold is None or not hold.confirmed:
                    continue
                distance = float(hand.geometry.vertex[o])
                if self._is_over(hold, hand.motion, placed, distance):
                    del self._holds[hand.id, placed.id]

    def _is_over(self, hold: _Hold, motion: Motion, placed: PlacedObject, distance: float) -> bool:
        length = 0.0 if placed.path is None else float(np.linalg.norm(_way(placed.path)))
        if distance > self._near + self._margin + LATE * length / WINDOW:
            return True
        if length > STILL_WAY:
            hold.offset, hold.away_since = None, math.nan
            return False
        offset = motion.position - placed.centre
        if hold.offset is None:
            hold.offset = offset
        if math.dist(offset, hold.offset) <= self._margin:
            hold.away_since = math.nan
        elif math.isnan(hold.away_since):
            hold.away_since = motion.t
        return motion.t - hold.away_since >= MIN_AWAY


def _way(path: Array) -> Array:
    """Return the way of an object in the newest window of its path, (3,) [m]."""
    begin = path[-1, 0] - WINDOW
    way: Array = path[-1, 1:] - np.array(
        [np.interp(begin, path[:, 0], path[:, axis]) for axis in (1, 2, 3)]
    )
    return way


def _at(times: deque[float], places: deque[Array], t: float) -> Array:
    """Return the place at a time, between two remembered ones or at the ends, (3,) [m]."""
    last = len(times) - 1
    k = last
    while k > 0 and times[k] > t:
        k -= 1
    after = min(k + 1, last)
    span = times[after] - times[k]
    part = 0.0 if span <= 0.0 else min(max((t - times[k]) / span, 0.0), 1.0)
    place: Array = (1.0 - part) * places[k] + part * places[after]
    return place
