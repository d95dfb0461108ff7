"""How objects look: a colour and a letter each, told apart with every kind of colour vision.

``static/looks.js`` has the same colours, and adds dashes: nothing is told by colour alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from threading import Lock

OBJECTS = ("#3d8bff", "#e25a00", "#195732", "#d369a9", "#65530b", "#7214ff", "#a32020", "#4f7f8f")
INK, PAPER = "#16202a", "#ffffff"
KEEP = 10.0  # seconds for which an object that is gone keeps its letter


def rgb(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue in 0-255 of ``#rrggbb``."""
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


def colour_of(number: int) -> str:
    """Return the colour of the object with this number."""
    return OBJECTS[number % len(OBJECTS)]


def letter_of(number: int) -> str:
    """Return the letter of the object with this number: A to Z, A1 to Z1 and so on."""
    turn, place = divmod(number, 26)
    return chr(ord("A") + place) + (str(turn) if turn else "")


class Looks:
    """The number of each object, from which its colour and letter follow; for any thread.

    Numbers of objects that are gone are given again: a tracker may number its objects anew.
    """

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}
        self._seen: dict[str, float] = {}
        self._lock = Lock()

    def update(self, ids: Iterable[str], t: float) -> bool:
        """Give numbers to what is there at time ``t`` [s]; return whether any has changed."""
        with self._lock:
            before = dict(self._numbers)
            ids = sorted(ids)
            self._seen |= dict.fromkeys(ids, t)
            for id, last in list(self._seen.items()):
                if not 0.0 <= t - last <= KEEP:
                    del self._seen[id]
                    self._numbers.pop(id, None)
            used = set(self._numbers.values())
            for id in ids:
                if id not in self._numbers:
                    free = next(k for k in range(len(used) + 1) if k not in used)
                    self._numbers[id] = free
                    used.add(free)
            return self._numbers != before

    def numbers(self) -> dict[str, int]:
        """Return the number of each object."""
        with self._lock:
            return dict(self._numbers)
