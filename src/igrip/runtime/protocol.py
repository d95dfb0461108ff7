"""The messages that other programs send: observations, and commands about a lease."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple, get_args

import msgspec

from igrip.entities import text
from igrip.errors import ObservationError
from igrip.estimator import Estimator
from igrip.intention import Intention
from igrip.io.defects import Defect
from igrip.io.message_reader import MessageReader, decode_json
from igrip.observation import Observation

Action = Literal["veto", "confirm", "opened"]
ACTIONS: tuple[Action, ...] = get_args(Action)
MAX_SIZE = 1 << 18  # bytes of a message: ten times that of 16 hands with landmarks, 256 objects


class Command(NamedTuple):
    """A command from outside about the lease of one hand; None: of every hand."""

    action: Action
    hand: str | None

    def apply(self, estimator: Estimator) -> list[Intention]:
        """Carry it out; return the intentions that it changes.

        Raises
        ------
        IgripError
            If no device assists that hand.
        """
        methods = {
            "veto": estimator.veto, "confirm": estimator.confirm,
            "opened": estimator.notify_released,
        }  # fmt: skip
        return methods[self.action](self.hand)


def decode(
    data: bytes | str, reader: MessageReader | None = None, defects: list[Defect] | None = None
) -> Observation | Command:
    """Return the message in JSON, or in MessagePack if it begins like a map of it.

    ``{"control": "veto", "hand": "right"}`` is a command, everything else an observation. The
    decoders bound nesting; size is bounded here.

    Parameters
    ----------
    data : bytes or str
        The message.
    reader : MessageReader, optional
        That of its sender.
    defects : list of Defect, optional
        What was wrong with parts of an observation is appended to it.

    Raises
    ------
    ObservationError
        If it is neither; no input raises anything else.
    """
    if len(data) > MAX_SIZE:
        raise ObservationError("message", f"is larger than {MAX_SIZE} bytes")
    if isinstance(data, bytes) and data[:1] >= b"\x80":
        try:
            raw = msgspec.msgpack.decode(data)
        except (msgspec.MsgspecError, ValueError, TypeError, RecursionError) as error:
            raise ObservationError("message", f"is not MessagePack: {error}") from None
    else:
        raw = decode_json(data)
    if isinstance(raw, Mapping) and "control" in raw:
        return _command(raw)
    try:
        observation, found = (reader or MessageReader()).read(raw)
    except RecursionError:
        raise ObservationError("message", "is nested too deeply") from None
    if defects is not None:
        defects += found
    return observation


def _command(raw: Mapping[str, Any]) -> Command:
    action, hand = raw["control"], raw.get("hand")
    if action not in ACTIONS:
        raise ObservationError("control", f"must be one of {', '.join(ACTIONS)}")
    return Command(action, None if hand is None else text(hand, "hand"))
