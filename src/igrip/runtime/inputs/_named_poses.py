"""Positions and poses that come by name, as messages: hands by their side, all else objects."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from igrip.io.hand_ids import is_hand, match_hand

POSITION, ROTATION = ("x", "y", "z"), ("qx", "qy", "qz", "qw")
_AXIS = re.compile(
    r"^(?P<name>.*?)"
    r"(?:[\s._/-]*(?P<kind>position|pos|translation|orientation|rotation|quaternion|quat|rot|ori)"
    r"|(?:^|[\s._/-]+)(?P<letter>[ptqr]))?"
    r"[\s._/-]*(?P<axis>[xyzw])$",
    re.IGNORECASE,
)
_ROTATIONS = {"orientation", "rotation", "quaternion", "quat", "rot", "ori", "q", "r"}
_METRES = {
    "m": 1.0, "meter": 1.0, "meters": 1.0, "metre": 1.0, "metres": 1.0,
    "dm": 0.1, "decimeter": 0.1, "decimeters": 0.1, "decimetre": 0.1, "decimetres": 0.1,
    "cm": 0.01, "centimeter": 0.01, "centimeters": 0.01, "centimetre": 0.01, "centimetres": 0.01,
    "mm": 0.001, "millimeter": 0.001, "millimeters": 0.001, "millimetre": 0.001,
    "millimetres": 0.001, "in": 0.0254, "inch": 0.0254, "inches": 0.0254,
}  # fmt: skip


class Channel(NamedTuple):
    """What one channel of a signal holds.

    Attributes
    ----------
    name : str
        Of the hand or object, such as ``right_hand``.
    part : str
        ``x``, ``y``, ``z`` or ``qx``, ``qy``, ``qz``, ``qw``.
    metres : float or None
        Length of its unit [m]; None: not declared.
    """

    name: str
    part: str
    metres: float | None


def channel_of(metadata: Mapping[str, str]) -> Channel | None:
    """Return what the metadata of a channel describe; None: no position and no rotation.

    They are those of XDF's MoCap streams (``object`` or ``marker``, ``type`` such as ``PositionX``)
    or labels with an axis at their end (``right.x``, ``mug_qw``).
    """
    kind, label = metadata.get("type", ""), metadata.get("label", "")
    name = metadata.get("object") or metadata.get("marker") or ""
    metres = _METRES.get(metadata.get("unit", "").strip().lower())
    declared = re.fullmatch(r"(Position|Orientation|Quaternion)([XYZW])", kind, re.IGNORECASE)
    found = _AXIS.match(label)
    if declared is not None:
        part = declared[2].lower()
        rotates = declared[1].lower() != "position"
        name = name or (found["name"] if found else label)
    elif found is not None:
        part, rotates = found["axis"].lower(), _kind(found) in _ROTATIONS
        name = name or found["name"]
    else:
        return None
    part = f"q{part}" if rotates or part == "w" else part
    return Channel(name.strip(" ._/-"), part, metres) if name.strip(" ._/-") else None


def _kind(found: re.Match[str]) -> str:
    return (found["kind"] or found["letter"] or "").lower()


class NamedPoses:
    """Turns named positions and poses into the parts of a message.

    Parameters
    ----------
    hands : sequence of str
        Ids of hands; other spellings of them are matched.

    Attributes
    ----------
    refused : dict of str to str
        Why a name is left out, by name.
    """

    def __init__(self, hands: Sequence[str]) -> None:
        self._hands = tuple(hands)
        self._known: dict[str, str | None] = {}
        self.refused: dict[str, str] = {}

    def hand(self, name: str) -> str | None:
        """Return the id of the hand that a name means; None: it is no hand, or refused."""
        if name not in self._known and len(self._known) < 1024:
            self._known[name] = match_hand(name, self._hands)
            if self._known[name] is None and is_hand(name):
                ids = ", ".join(self._hands)
                self.refused[name] = (
                    f"{name!r:.60} is none of the hands {ids}: name it so, or give --assisted"
                )
        return self._known.get(name)

    def add(
        self, message: dict[str, Any], name: str, position: Sequence[float],
        rotation: Sequence[float] | None,
    ) -> None:  # fmt: skip
        """Put a hand or object into a message; one that cannot be is noted as refused."""
        hand = self.hand(name)
        if hand is not None:
            message["hands"][hand] = {"position": list(position)}
            if rotation is not None:
                message["hands"][hand]["orientation"] = list(rotation)
        elif name in self.refused:
            return
        elif rotation is None:
            if len(self.refused) < 64:
                self.refused[name] = (
                    f"{name!r:.60} is no hand ({', '.join(self._hands)}), and an object needs a "
                    "rotation too"
                )
        else:
            message["objects"][name] = {
                "position": list(position), "orientation": list(rotation), "model": name,
            }  # fmt: skip


class Layout:
    """Where the channels of a signal are.

    Parameters
    ----------
    channels : iterable of Channel or None
        In their order; None: of no use.
    order : str
        Order of the components of quaternions in messages, ``xyzw`` or ``wxyz``.

    Attributes
    ----------
    metres : float or None
        Length of the unit of the messages' positions [m]; None: not declared. Where the channels
        have several units, positions are converted to metres.
    """

    def __init__(self, channels: Iterable[Channel | None], order: str = "xyzw") -> None:
        self._parts: dict[str, dict[str, int]] = {}
        self._rotation = ROTATION if order == "xyzw" else ("qw", "qx", "qy", "qz")
        units: dict[int, float | None] = {}
        for index, channel in enumerate(channels):
            if channel is not None:
                self._parts.setdefault(channel.name, {})[channel.part] = index
                if channel.part in POSITION:
                    units[index] = channel.metres
        self._parts = {n: p for n, p in self._parts.items() if set(POSITION) <= set(p)}
        self._scales: dict[int, float] = {}
        one_unit = len(set(units.values())) == 1
        self.metres = next(iter(units.values())) if one_unit else None
        if len(set(units.values())) > 1:
            self.metres = 1.0
            self._scales = {k: 1.0 if unit is None else unit for k, unit in units.items()}

    @property
    def is_converted(self) -> bool:
        """Whether positions are converted to metres."""
        return bool(self._scales)

    @property
    def names(self) -> list[str]:
        """The hands and objects whose position is given."""
        return list(self._parts)

    def message(self, t: float, sample: Sequence[float], poses: NamedPoses) -> dict[str, Any]:
        """Return the message in one sample at its time [the source's unit]."""
        message: dict[str, Any] = {"t": t, "hands": {}, "objects": {}}
        for name, parts in self._parts.items():
            position = [sample[k] * self._scales.get(k, 1.0) for k in (parts[a] for a in POSITION)]
            turns = set(ROTATION) <= set(parts)
            rotation = [sample[parts[axis]] for axis in self._rotation] if turns else None
            poses.add(message, name, position, rotation)
        return message
