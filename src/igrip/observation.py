"""Observations: the messages that every source yields and that the estimator reads."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

import msgspec

from igrip.entities import Hand, ObjectPose, kind_of, text, time_of
from igrip.errors import ObservationError

SCHEMA: Literal["igrip/1"] = "igrip/1"
RESERVED_OBJECT_ID = "none"


class Message(msgspec.Struct, frozen=True, kw_only=True):
    """The wire form of an :class:`Observation`; its JSON schema is generated from here."""

    t: float
    hands: dict[str, Hand | None] = {}
    objects: dict[str, ObjectPose | None] = {}
    schema: Literal["igrip/1"] = SCHEMA


_HAND_FIELDS = frozenset(Hand.__struct_fields__)
_OBJECT_FIELDS = frozenset(ObjectPose.__struct_fields__)
_REQUIRED: Mapping[type[Any], tuple[str, ...]] = {
    Hand: ("position",),
    ObjectPose: ("position", "orientation"),
}
_EMPTY: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, slots=True, init=False)
class Observation:
    """One message: measurements of hands and objects, and when it arrived. Immutable.

    A message without hands and objects is a *tick*: time has passed.
    ``Observation(**json.loads(line))`` is valid; unknown fields are kept out and counted.

    Parameters
    ----------
    t : float
        Arrival on one monotonic clock [s], not negative.
    hands : mapping of str to Hand, dict or None
        By id. None: looked for and not detected. An absent id: no news.
    objects : mapping of str to ObjectPose, dict or None
        By id; the id ``none`` is reserved.
    schema : str
        ``"igrip/1"``.

    Attributes
    ----------
    unknown_fields : int
        How many fields of the message were not known and left out.
    not_seen : mapping of str to str
        Why hands and objects that the message holds are taken as not detected, by path
        (``hands.right``); see :meth:`annotated`.
    invalid : str or None
        Why none of its measurements may be used; None: they may.

    Raises
    ------
    ObservationError
        If anything is malformed; its ``field`` names the place.
    """

    t: float
    hands: Mapping[str, Hand | None]
    objects: Mapping[str, ObjectPose | None]
    schema: str
    unknown_fields: int = field(compare=False)
    not_seen: Mapping[str, str] = field(compare=False)
    invalid: str | None = field(compare=False)

    def __init__(
        self,
        /,
        t: float | None = None,  # a missing time is reported like any other malformed field
        hands: Mapping[str, Any] = _EMPTY,
        objects: Mapping[str, Any] = _EMPTY,
        schema: str = SCHEMA,
        **unknown: Any,
    ) -> None:
        if not isinstance(schema, str) or schema != SCHEMA:
            got = repr(schema[:40]) if isinstance(schema, str) else kind_of(schema)
            raise ObservationError("schema", f"must be {SCHEMA!r}, got {got}")
        put = object.__setattr__
        put(self, "t", time_of(t, "t"))
        known_hands, extra_hands = _entities(hands, Hand, _HAND_FIELDS, "hands")
        known_objects, extra_objects = _entities(objects, ObjectPose, _OBJECT_FIELDS, "objects")
        if RESERVED_OBJECT_ID in known_objects:
            raise ObservationError(
                f"objects.{RESERVED_OBJECT_ID}", "this id is reserved for 'no target'"
            )
        put(self, "hands", MappingProxyType(known_hands))
        put(self, "objects", MappingProxyType(known_objects))
        put(self, "schema", SCHEMA)
        put(self, "unknown_fields", len(unknown) + extra_hands + extra_objects)
        put(self, "not_seen", _EMPTY)
        put(self, "invalid", None)

    def annotated(
        self, not_seen: Mapping[str, str] | None = None, invalid: str | None = None
    ) -> Observation:
        """Return the same message with what an edge found out about it; it is not written.

        Parameters
        ----------
        not_seen : mapping of str to str, optional
            Why entities of the message are taken as not detected, by path.
        invalid : str, optional
            Why none of its measurements may be used, such as a clock that was just set.
        """
        copy = object.__new__(Observation)
        for name in self.__slots__:
            object.__setattr__(copy, name, getattr(self, name))
        if not_seen is not None:
            object.__setattr__(copy, "not_seen", MappingProxyType(dict(not_seen)))
        if invalid is not None:
            object.__setattr__(copy, "invalid", invalid)
        return copy

    @property
    def is_tick(self) -> bool:
        """Whether the message carries no entities."""
        return not self.hands and not self.objects

    @classmethod
    def from_dict(cls, message: Mapping[str, Any]) -> Observation:
        """Build an observation from decoded JSON or MessagePack."""
        if not isinstance(message, Mapping):
            raise ObservationError("message", f"must be an object, got {kind_of(message)}")
        if not all(isinstance(key, str) for key in message):
            raise ObservationError("message", "every key must be a string")
        return cls(**message)

    @classmethod
    def from_json(cls, line: bytes | str) -> Observation:
        """Build an observation from one JSON text.

        Raises
        ------
        ObservationError
            If it is not JSON (field ``message``), or malformed (the field's own path).
        """
        try:
            raw = msgspec.json.decode(line)
        except (ValueError, TypeError, RecursionError) as error:
            raw = _lenient_json(line, error)
        return cls.from_dict(raw)

    def to_dict(self) -> dict[str, Any]:
        """Return the message as plain dictionaries, lists and numbers."""
        message: dict[str, Any] = {"schema": self.schema, "t": self.t}
        if self.hands:
            message["hands"] = msgspec.to_builtins(dict(self.hands))
        if self.objects:
            message["objects"] = msgspec.to_builtins(dict(self.objects))
        return message

    def to_json(self) -> bytes:
        """Return the message as one line of JSON, without a line break."""
        return msgspec.json.encode(self.to_dict())

    def __reduce__(self) -> tuple[Any, tuple[dict[str, Any]]]:
        return Observation.from_dict, (self.to_dict(),)

    def __hash__(self) -> int:
        return hash((self.t, frozenset(self.hands.items()), frozenset(self.objects.items())))

    @staticmethod
    def json_schema() -> dict[str, Any]:
        """Return the JSON schema of a message."""
        return msgspec.json.schema(Message)


def _entities(
    raw: Mapping[str, Any], kind: type[Any], fields: frozenset[str], path: str
) -> tuple[dict[str, Any], int]:
    """Validate all hands or all objects; also count the fields that are not known."""
    if not isinstance(raw, Mapping):
        raise ObservationError(path, f"must be an object, got {kind_of(raw)}")
    known: dict[str, Any] = {}
    extra = 0
    for name, value in raw.items():
        text(name, path)
        if value is None or isinstance(value, kind):
            known[name] = value
            continue
        known[name] = _entity(value, kind, fields, f"{path}.{name:.80}")
        extra += len(value.keys() - fields)
    return known, extra


def _entity(value: Any, kind: type[Any], fields: frozenset[str], path: str) -> Any:
    if not isinstance(value, Mapping):
        raise ObservationError(path, f"must be an object or null, got {kind_of(value)}")
    for name in _REQUIRED[kind]:
        if name not in value:
            raise ObservationError(f"{path}.{name}", "is missing")
    try:
        return kind(**{name: item for name, item in value.items() if name in fields})
    except ObservationError as error:
        raise ObservationError(f"{path}.{error.field}", error.problem) from None


def _lenient_json(line: bytes | str, error: Exception) -> Any:
    """Decode what msgspec refuses (NaN, 1e999), so that the error can name the field."""
    try:
        return json.loads(line)
    except (ValueError, TypeError, RecursionError):
        raise ObservationError("message", f"is not JSON: {error}") from None
