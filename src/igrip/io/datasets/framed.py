"""A recording whose numbers are in a declared frame, as observations in igrip's."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import msgspec

from igrip.io.frames import DeclaredFrame
from igrip.io.recordings import Source
from igrip.observation import Observation


@dataclass
class FramedSource:
    """Observations of a source, converted from a declared frame.

    Attributes
    ----------
    source : iterable of Observation
        With numbers as they were recorded.
    frame : DeclaredFrame
        What these mean.
    """

    source: Source
    frame: DeclaredFrame

    @property
    def cut(self) -> str | None:
        """Where the recording was cut off, after an iteration."""
        return getattr(self.source, "cut", None)

    def __iter__(self) -> Iterator[Observation]:
        if self.frame.is_default:
            yield from self.source
            return
        for observation in self.source:
            yield convert(observation, self.frame)


def convert(observation: Observation, frame: DeclaredFrame) -> Observation:
    """Return an observation in igrip's frame and units."""
    hands = {id: _converted(hand, frame) for id, hand in observation.hands.items()}
    objects = {id: _converted(pose, frame) for id, pose in observation.objects.items()}
    time = float(frame.times(observation.t))
    return Observation(t=time, hands=hands, objects=objects)


def _converted(entity: Any, frame: DeclaredFrame) -> Any:
    """Return a hand or an object in igrip's frame; None stays."""
    if entity is None:
        return None
    changes: dict[str, Any] = {"position": tuple(frame.positions(entity.position).tolist())}
    if entity.orientation is not None:
        changes["orientation"] = tuple(frame.orientations(entity.orientation).tolist())
    if entity.t is not None:
        changes["t"] = float(frame.times(entity.t))
    if entity.std is not None:
        std = frame.deviations(entity.std)
        changes["std"] = float(std) if std.ndim == 0 else tuple(std.tolist())
    landmarks = getattr(entity, "landmarks", None)
    if landmarks is not None:
        changes["landmarks"] = tuple(map(tuple, frame.positions(landmarks).tolist()))
    return msgspec.structs.replace(entity, **changes)
