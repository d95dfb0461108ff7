"""Hands and objects of a recording as columns of numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Hand, ObjectPose
from igrip.observation import Observation

Array = NDArray[np.float64]
POSITION, ROTATION = ("x", "y", "z"), ("qx", "qy", "qz", "qw")


@dataclass(frozen=True)
class Track:
    """One hand or object over the times of a recording; NaN where it was not seen.

    Attributes
    ----------
    name : str
        ``hand_ID`` or ``object_ID``.
    positions : (n, 3)
        Palm centre, or origin of the mesh [m].
    rotations : (n, 4) or None
        Unit quaternions x, y, z, w; None: never known.
    """

    name: str
    positions: Array
    rotations: Array | None

    def columns(self) -> Iterator[tuple[str, Array]]:
        """Yield each component and its numbers (n,)."""
        yield from zip(POSITION, self.positions.T, strict=True)
        if self.rotations is not None:
            yield from zip(ROTATION, self.rotations.T, strict=True)


@dataclass(frozen=True)
class Tracks:
    """All hands and objects of a recording.

    Attributes
    ----------
    times : (n,)
        Of each message [s].
    tracks : list of Track
        Hands first.
    """

    times: Array
    tracks: list[Track]


def track_entities(observations: Iterable[Observation]) -> Tracks:
    """Return the columns of a recording.

    A static object stays where it was reported until a message says that it is not seen.
    """
    messages = list(observations)
    times = np.array([message.t for message in messages], dtype=np.float64)
    tracks = _tracks("hand", [message.hands for message in messages])
    tracks += _tracks("object", [message.objects for message in messages])
    return Tracks(times, tracks)


def _tracks(
    kind: str, messages: list[Mapping[str, Hand | None]] | list[Mapping[str, ObjectPose | None]]
) -> list[Track]:
    count = len(messages)
    positions: dict[str, Array] = {}
    rotations: dict[str, Array] = {}
    still: dict[str, ObjectPose] = {}
    for k, entities in enumerate(messages):
        for id, entity in entities.items():
            if isinstance(entity, ObjectPose) and entity.static:
                still[id] = entity
            else:
                still.pop(id, None)
        for id, entity in {**entities, **still}.items():
            if entity is None:
                continue
            positions.setdefault(id, np.full((count, 3), np.nan))[k] = entity.position
            if entity.orientation is not None:
                rotations.setdefault(id, np.full((count, 4), np.nan))[k] = entity.orientation
    return [Track(f"{kind}_{id}", positions[id], rotations.get(id)) for id in positions]
