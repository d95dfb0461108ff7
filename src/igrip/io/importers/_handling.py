"""Reaches within recordings of hands that handle objects: each ends when an object begins to move.

Sets of hand-object interaction have no trials of reaching. A reach is what a hand did before an
object that had rested was moved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from igrip.io.recorded_reach import MovingObject, RecordedReach
from igrip.io.takes.take import Array, Track

MOVED = 0.01  # m from its place: the object was moved
REST = 0.5  # s it must have rested before
BEFORE, AFTER = 2.0, 0.1  # s that a reach's recording holds before and after
NEAR = 0.3  # m: no hand is nearer: nobody took it
TRAVEL = 0.05  # m that the hand came from, at least
MIN_SAMPLES = 10


def moves_of(track: Track) -> Iterator[float]:
    """Yield the times [s] at which an object that had rested began to move."""
    if not len(track.times):
        return
    place, since = track.positions[0], float(track.times[0])
    for t, position in zip(track.times.tolist(), track.positions, strict=True):
        if np.linalg.norm(position - place) > MOVED:
            if t - since >= REST:
                yield t
            place, since = position, t


def find_reaches(
    name: str, participant: str, hands: Mapping[str, Track], objects: Mapping[str, Track],
    models: Mapping[str, str], only: str | None = None,
) -> list[RecordedReach]:  # fmt: skip
    """Return the reaches of one recording.

    Parameters
    ----------
    name, participant : str
        Of the recording; reaches are numbered.
    hands, objects : mapping of str to Track
        By id, in igrip's world; the objects' tracks are those of their meshes.
    models : mapping of str to str
        Models of objects in the catalogue, where they have one.
    only : str, optional
        The object that was to be taken; what else moved does not count.
    """
    events = sorted(
        (t, id) for id, track in objects.items() if only in (None, id) for t in moves_of(track)
    )
    free_from = dict.fromkeys(hands, -np.inf)  # when each hand finished its last reach
    reaches: list[RecordedReach] = []
    for t, target in events:
        place = _at(objects[target], t)
        near = {
            id: float(np.linalg.norm(_at(track, t) - place))
            for id, track in hands.items()
            if len(track.times) and track.times[0] <= t <= track.times[-1] + AFTER
        }
        hand = min(near, key=lambda id: near[id], default=None)
        if hand is None or near[hand] > NEAR:
            continue
        begin = max(t - BEFORE, free_from[hand])
        free_from[hand] = t
        own = _cut(hands[hand], begin, t + AFTER)
        if len(own.times) < MIN_SAMPLES:
            continue
        if np.linalg.norm(own.positions - own.positions[-1], axis=1).max() < TRAVEL:
            continue
        start = float(own.times[0])
        reaches.append(RecordedReach(
            name=f"{name}_{len(reaches) + 1:03d}", participant=participant,
            trial=f"{name}_{len(reaches) + 1}", hand=hand, target=target,
            times=own.times - start, positions=own.positions, object_positions={},
            models={id: model for id, model in models.items() if id in objects},
            movement_only=False,
            moving_objects={
                id: MovingObject(_shift(_cut(track, start, t + AFTER), start), "mesh")
                for id, track in objects.items()
            },
            other_hands={
                id: _shift(_cut(track, start, t + AFTER), start)
                for id, track in hands.items() if id != hand
            },
        ))  # fmt: skip
    return reaches


def _at(track: Track, t: float) -> Array:
    """Return where a body was at the sample nearest to a time [s]."""
    position: Array = track.positions[int(np.argmin(np.abs(track.times - t)))]
    return position


def _cut(track: Track, begin: float, end: float) -> Track:
    within = (track.times >= begin) & (track.times <= end)
    turns = None if track.orientations is None else track.orientations[within]
    return Track(track.times[within], track.positions[within], turns)


def _shift(track: Track, start: float) -> Track:
    return replace(track, times=track.times - start)
