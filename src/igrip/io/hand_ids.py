"""Hand ids in other spellings: ``Right``, ``R``, ``right_hand``, ``hand_0``."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Literal

Side = Literal["left", "right"]

_SIDES: dict[str, Side] = {
    "r": "right", "right": "right", "rh": "right", "rt": "right",
    "l": "left", "left": "left", "lh": "left", "lt": "left",
    "rechts": "right", "droite": "right", "derecha": "right", "destra": "right",
    "links": "left", "gauche": "left", "izquierda": "left", "sinistra": "left",
}  # fmt: skip
_PARTS = frozenset({
    "hand", "palm", "wrist", "fist", "glove", "index", "finger", "fingertip", "thumb", "knuckle",
    "controller", "marker", "tip",
    "main", "mano",
    "fin", "wra", "wrb",  # the hand and the wrist of Plug-in Gait
})  # fmt: skip

_HAND_WORDS = _PARTS - {"marker", "tip", "index", "controller", "main"}

_JOINED = re.compile(r"(right|left|r|l)(hand|palm|wrist|index|thumb|finger|fin|wra|wrb)")


def side_of(name: str) -> Side | None:
    """Return the side of a hand by its name; None where the name has none.

    Examples
    --------
    >>> [side_of(name) for name in ("Right", "L", "RightHand", "hand_l", "rWrist", "mug")]
    ['right', 'left', 'right', 'left', 'right', None]
    """
    words = _words(name)
    sides = {_SIDES[word] for word in words if word in _SIDES}
    rest = [word for word in words if word not in _SIDES and not word.isdigit()]
    if len(sides) == 1 and all(word in _PARTS for word in rest):
        return sides.pop()
    return None


def is_hand(name: str) -> bool:
    """Return whether a name is that of a hand or a part of it."""
    return side_of(name) is not None or any(word in _HAND_WORDS for word in _words(name))


def match_hand(name: str, known: Collection[str]) -> str | None:
    """Return the one of the known ids that a name stands for; None where none or several do.

    The same id first, then one that differs by case alone, then one of the same side.

    Examples
    --------
    >>> match_hand("Right", ["left", "right"]), match_hand("hand_0", ["left", "right"])
    ('right', None)
    """
    if name in known:
        return name
    alike = [id for id in known if _words(id) == _words(name)]
    if len(alike) == 1:
        return alike[0]
    side = side_of(name)
    same = [id for id in known if side is not None and side_of(id) == side]
    return same[0] if len(same) == 1 else None


def _words(name: str) -> list[str]:
    """Return the words of a name in lower case: ``RightHand_2`` is right, hand, 2."""
    apart = re.sub(r"(?<=[a-z])(?=[A-Z0-9])|(?<=[A-Z])(?=[A-Z][a-z])", " ", name)
    words = [word.lower() for word in re.findall(r"[^\W\d_]+|\d+", apart)]
    joined: list[str] = []
    for word in words:  # "righthand", "lwrist"
        match = _JOINED.fullmatch(word)
        joined += list(match.groups()) if match else [word]
    return joined
