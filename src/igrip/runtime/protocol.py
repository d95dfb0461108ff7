"""What producers send, taken apart: observations go on, words to the device's lease too."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

import msgspec

from igrip.entities import text
from igrip.errors import ObservationError
from igrip.observation import Observation

Word = Literal["veto", "confirm", "opened"]
WORDS: tuple[Word, ...] = ("veto", "confirm", "opened")
METHODS = {"veto": "veto", "confirm": "confirm", "opened": "notify_released"}  # of Estimator
LARGEST = 1 << 18  # bytes of a message: ten times what 16 hands with landmarks and 256 objects take


MAX_HANDS, MAX_OBJECTS, MAX_ID_LENGTH = 32, 512, 128


class Command(NamedTuple):
    """A word from outside about the lease of one hand, or of all."""

    word: Word
    hand: str | None


def decode(data: bytes | str) -> Observation | Command:
    """Return what a message says: JSON, or MessagePack if it begins like a map of it.

    ``{"control": "veto", "hand": "right"}`` is a word about a lease, everything else an
    observation. Nesting is bounded by the decoders, size here.

    Raises
    ------
    ObservationError
        If it is neither; nothing else is raised, whatever comes.
    """
    if len(data) > LARGEST:
        raise ObservationError("message", f"is larger than {LARGEST} bytes")
    if isinstance(data, bytes) and data[:1] >= b"\x80":
        try:
            raw = msgspec.msgpack.decode(data)
        except (msgspec.MsgspecError, ValueError, TypeError, RecursionError) as error:
            raise ObservationError("message", f"is not MessagePack: {error}") from None
    else:
        try:
            raw = msgspec.json.decode(data)
        except (ValueError, TypeError, RecursionError):
            return Observation.from_json(data)  # it names the field that is wrong
    if isinstance(raw, Mapping) and "control" in raw:
        return _control(raw)
    _check_size(raw)
    try:
        return Observation.from_dict(raw)
    except RecursionError:
        raise ObservationError("message", "is nested too deeply") from None


def _check_size(raw: Any) -> None:
    """Refuse what no scene holds: it would cost everybody's time, and be told to everybody."""
    if not isinstance(raw, Mapping):
        return
    for part, most in (("hands", MAX_HANDS), ("objects", MAX_OBJECTS)):
        entities = raw.get(part)
        if not isinstance(entities, Mapping):
            continue
        if len(entities) > most:
            raise ObservationError(part, f"are {len(entities)}, more than {most}")
        if any(isinstance(id, str) and len(id) > MAX_ID_LENGTH for id in entities):
            raise ObservationError(part, f"an id has more than {MAX_ID_LENGTH} characters")


def _control(raw: Mapping[str, Any]) -> Command:
    word, hand = raw["control"], raw.get("hand")
    if word not in WORDS:
        raise ObservationError("control", f"must be one of {', '.join(WORDS)}")
    return Command(word, None if hand is None else text(hand, "hand"))
