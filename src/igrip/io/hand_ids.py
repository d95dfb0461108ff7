"""The ids of hands in the spellings of other programs."""

from __future__ import annotations

import re
from collections.abc import Iterable

SIDES = {
    "right": "right", "r": "right", "rh": "right", "left": "left", "l": "left", "lh": "left",
}  # fmt: skip
_FILLERS = {"hand", "palm", "wrist", "the", "tracker", "marker"}


def side_of(id: str) -> str | None:
    """Return ``right`` or ``left`` for a spelling of it (``R``, ``right_hand``, ``RightHand``).

    None where it shows no side, as ``hand_0``.
    """
    words = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", id)
    sides = {SIDES.get(word.lower()) for word in words if word.lower() not in _FILLERS}
    return sides.pop() if len(sides) == 1 else None


def is_hand(id: str) -> bool:
    """Whether an id is that of a hand: it shows a side, or holds the word."""
    return side_of(id) is not None or "hand" in id.lower()


def match_hand(id: str, choices: Iterable[str]) -> str | None:
    """Return the one of ``choices`` that an id means; None: none, or more than one."""
    known = list(choices)
    if id in known:
        return id
    same = [choice for choice in known if choice.lower() == id.lower()]
    side = side_of(id)
    same = same or [choice for choice in known if side is not None and side_of(choice) == side]
    return same[0] if len(same) == 1 else None
