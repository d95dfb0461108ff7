"""Messages from elsewhere, entity by entity: the one rule of every input and recording.

A hand or object that cannot be understood counts as looked for and not seen, with its reason; the
rest of the message is taken. Only a broken envelope refuses a message: no object, no time, another
schema.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

import msgspec

from igrip.entities import Hand, ObjectPose, kind_of, number
from igrip.errors import ObservationError
from igrip.io.defects import Defect
from igrip.io.frames import DeclaredFrame
from igrip.io.missing_markers import is_missing_marker
from igrip.observation import RESERVED_OBJECT_ID, SCHEMA, Observation

ROUNDED_NORM = 0.02  # from 1 of a quaternion that was rounded to two decimals, at most
ZERO_DISTANCE = 0.1  # m from 0 0 0; an entity that was farther away is not there but lost
MAX_HANDS, MAX_OBJECTS, MAX_ID_LENGTH = 32, 512, 128
BELOW_ZERO = 3  # messages in a row dated below zero that make a step of the clock
MAX_REMEMBERED = 1024  # entities whose newest position is remembered

_KINDS: Mapping[str, tuple[type[Any], int]] = {
    "hands": (Hand, MAX_HANDS), "objects": (ObjectPose, MAX_OBJECTS),
}  # fmt: skip
_NEEDED: Mapping[type[Any], set[str]] = {
    Hand: {"position", "t"},
    ObjectPose: {"position", "t", "orientation", "model"},
}
# what other languages print for numbers that are none; only outside of a strict reading
_NO_NUMBER = re.compile(
    rb"(?<=[\[:,\s])[-+]?(?:nan|inf|infinity|1\.#\w+)(?:\(\w*\))?(?=[\s,\]}])", re.IGNORECASE
)


def decode_json(data: bytes | str) -> Any:
    """Return the value of one JSON text; NaN and its like are numbers.

    Raises
    ------
    ObservationError
        If it is not JSON.
    """
    try:
        return msgspec.json.decode(data)
    except (ValueError, TypeError, RecursionError) as error:
        problem = error
    try:
        raw = data.encode("utf-8", "replace") if isinstance(data, str) else data
        return json.loads(_NO_NUMBER.sub(b"NaN", raw))
    except (ValueError, TypeError, RecursionError):
        raise ObservationError("message", f"is not JSON: {problem}") from None


class MessageReader:
    """Reads the messages of one sender or recording.

    Parameters
    ----------
    frame : DeclaredFrame
        Frame and units of the messages.

    Attributes
    ----------
    shift : float
        Added to all times, since they began below zero [s].
    """

    def __init__(self, frame: DeclaredFrame | None = None) -> None:
        self._frame = frame or DeclaredFrame()
        self.shift = 0.0
        self._begun, self._below = False, 0  # messages in a row that are dated below zero
        self._places: dict[tuple[str, str], tuple[float, ...]] = {}

    def read(self, raw: Any) -> tuple[Observation, list[Defect]]:
        """Return the observation in a decoded message, and what was wrong with parts of it.

        Raises
        ------
        ObservationError
            If the envelope is broken.
        """
        if not isinstance(raw, Mapping):
            raise ObservationError("message", f"must be an object, got {kind_of(raw)}")
        if self._frame.is_default and not self.shift and self._is_small(raw):
            try:
                observation = Observation.from_dict(raw)
            except (ObservationError, RecursionError):
                pass
            else:
                if not self._has_markers(observation):
                    self._begun, self._below = True, 0
                    return observation, []
        return self._read_apart(raw)

    def _is_small(self, raw: Mapping[str, Any]) -> bool:
        for part, (_, limit) in _KINDS.items():
            entities = raw.get(part)
            if not isinstance(entities, Mapping):
                continue
            if len(entities) > limit:
                return False
            for id in entities:
                if isinstance(id, str) and len(id) > MAX_ID_LENGTH:
                    return False
        return True

    def _has_markers(self, observation: Observation) -> bool:
        """Return whether a position may stand for "not there", and remember the positions."""
        for part, entities in (("hands", observation.hands), ("objects", observation.objects)):
            for entity in entities.values():
                if entity is not None and _is_suspicious(entity.position):
                    return True
            for id, entity in entities.items():
                if entity is not None:
                    self._remember(part, id, entity.position)
        return False

    def _read_apart(self, raw: Mapping[str, Any]) -> tuple[Observation, list[Defect]]:
        """Read each entity by itself."""
        defects: list[Defect] = []
        envelope = {key: value for key, value in raw.items() if isinstance(key, str)}
        schema = envelope.get("schema", SCHEMA)
        if not isinstance(schema, str) or schema != SCHEMA:
            Observation(t=0.0, schema=schema)  # raises
        if len(envelope) < len(raw):
            defects.append(Defect("left out", "message", "a key is no string"))
        t = self._time(number(envelope.get("t"), "t"), defects)
        message: dict[str, Any] = envelope | {"t": t}
        for part in _KINDS:
            if part in envelope:
                message[part] = self._entities(part, envelope[part], defects)
        try:
            observation = Observation.from_dict(message)
        except RecursionError:
            raise ObservationError("message", "is nested too deeply") from None
        lost = {d.path: d.problem for d in defects if d.kind == "not seen"}
        return observation.annotated(not_seen=lost) if lost else observation, defects

    def _time(self, t: float, defects: list[Defect]) -> float:
        """Return a time that is not below zero: times may begin there, or step there and stay."""
        t *= self._frame.seconds
        self._below = self._below + 1 if t + self.shift < 0.0 else 0
        if self._below and (not self._begun or self._below >= BELOW_ZERO):
            self.shift, self._below = -t, 0
            defects.append(Defect("corrected", "t", f"is {t:.6g} s: times count from there"))
        self._begun = True
        if self._below:
            raise ObservationError("t", f"is {t:.6g} s, before all times so far")
        return t + self.shift

    def _entities(self, part: str, raw: Any, defects: list[Defect]) -> dict[str, Any]:
        if not isinstance(raw, Mapping):
            defects.append(Defect("left out", part, f"must be an object, got {kind_of(raw)}"))
            return {}
        kind, limit = _KINDS[part]
        entities: dict[str, Any] = {}
        for id, value in raw.items():
            problem = _problem_of_id(part, id)
            if problem is None and len(entities) >= limit:
                problem = f"more than {limit} are sent"
            if problem is not None:
                path = f"{part}.{id:.80}" if isinstance(id, str) and len(id) < 80 else part
                defects.append(Defect("left out", ascii(path)[1:-1], problem))
                continue
            entities[id] = None if value is None else self._entity(part, id, kind, value, defects)
        return entities

    def _entity(
        self, part: str, id: str, kind: type[Any], value: Any, defects: list[Defect]
    ) -> dict[str, Any] | None:
        """Return an entity without what is wrong with it; None: it counts as not seen."""
        path = f"{part}.{id:.80}"
        if not isinstance(value, Mapping):
            problem = f"must be an object or null, got {kind_of(value)}"
            defects.append(Defect("not seen", path, problem))
            return None
        entity = {key: item for key, item in value.items() if isinstance(key, str)}
        for _ in range(len(kind.__struct_fields__) + 1):
            try:
                self._check(kind, entity)
                break
            except (ObservationError, RecursionError) as error:
                if not isinstance(error, ObservationError):
                    error = ObservationError("position", "is nested too deeply")
                name = re.split(r"[.\[]", error.field, maxsplit=1)[0]
                if name == "orientation" and (rounded := _normalised(entity.get(name))) is not None:
                    problem = f"its norm was {math.hypot(*entity[name]):.4g}"
                    defects.append(Defect("corrected", f"{path}.{name}", problem))
                    entity[name] = rounded
                elif name in _NEEDED[kind]:
                    defects.append(Defect("not seen", path, str(error)))
                    return None
                else:
                    defects.append(Defect("left out", f"{path}.{name}", error.problem))
                    del entity[name]
        if entity.get("t") is not None:
            entity["t"] = entity["t"] * self._frame.seconds + self.shift
            if entity["t"] < 0.0:  # at zero it would look younger than it is
                defects.append(Defect("not seen", path, "t: is before all times that count"))
                return None
        marker = self._missing_marker(part, id, entity["position"])
        if marker is not None:
            defects.append(Defect("not seen", path, marker))
            return None
        return self._converted(entity)

    def _check(self, kind: type[Any], entity: dict[str, Any]) -> None:
        for name in ("position", "orientation") if kind is ObjectPose else ("position",):
            if name not in entity:
                raise ObservationError(name, "is missing")
        fields = {key: entity[key] for key in kind.__struct_fields__ if key in entity}
        if fields.get("t") is not None:
            fields["t"] = abs(number(fields["t"], "t"))
        kind(**fields)

    def _missing_marker(self, part: str, id: str, position: Any) -> str | None:
        """Return what a position stands for in place of a place; None: it is a place."""
        numbers = [float(x) for x in position]
        if is_missing_marker(numbers):
            return f"position {' '.join(f'{x:g}' for x in numbers)} stands for not there"
        if any(numbers):
            self._remember(part, id, numbers)
            return None
        before = self._places.get((part, id), (0.0, 0.0, 0.0))
        if math.hypot(*before) * self._frame.metres > ZERO_DISTANCE:
            return "position 0 0 0 stands for not there"
        return None

    def _remember(self, part: str, id: str, position: Any) -> None:
        """Keep where an entity was last when it was not at 0 0 0."""
        if (part, id) not in self._places and len(self._places) >= MAX_REMEMBERED:
            del self._places[next(iter(self._places))]
        self._places[part, id] = tuple(position)

    def _converted(self, entity: dict[str, Any]) -> dict[str, Any]:
        """Return an entity in igrip's own frame and units."""
        frame = self._frame
        if frame.is_default:
            return entity
        entity["position"] = frame.positions(entity["position"]).tolist()
        if entity.get("orientation") is not None:
            entity["orientation"] = frame.orientations(entity["orientation"]).tolist()
        if entity.get("landmarks"):
            entity["landmarks"] = frame.positions(entity["landmarks"]).tolist()
        if entity.get("std") is not None:
            entity["std"] = frame.deviations(entity["std"]).tolist()
        return entity


def _is_suspicious(position: tuple[float, float, float]) -> bool:
    x, y, z = position
    return not (x or y or z) or max(abs(x), abs(y), abs(z)) >= 999.0


def _problem_of_id(part: str, id: Any) -> str | None:
    if not isinstance(id, str):
        return f"an id must be a string, got {kind_of(id)}"
    if len(id) > MAX_ID_LENGTH:
        return f"an id has more than {MAX_ID_LENGTH} characters"
    try:
        id.encode()
    except UnicodeEncodeError:
        return "an id is no text"
    if part == "objects" and id == RESERVED_OBJECT_ID:
        return "this id is reserved for 'no target'"
    return None


def _normalised(quaternion: Any) -> list[float] | None:
    """Return a quaternion that was rounded as a unit one; None: it is another one."""
    try:
        numbers = [number(x, "orientation") for x in quaternion]
    except (ObservationError, TypeError):
        return None
    norm = math.hypot(*numbers)
    if len(numbers) != 4 or not 0.0 < abs(norm - 1.0) <= ROUNDED_NORM:
        return None
    return [x / norm for x in numbers]
