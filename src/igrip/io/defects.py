"""What was wrong with parts of messages: counted by place, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

MAX_PLACES = 64  # whose defects are counted apart; those of all others together
OTHERS = "others"

Kind = Literal["not seen", "left out", "corrected", "skipped", "gap"]


class Defect(NamedTuple):
    """One defect of one message.

    Attributes
    ----------
    kind : str
        What was done: an entity is ``not seen``, a field of it ``left out`` or ``corrected``, a
        message ``skipped``; ``gap``: there is no message for some time.
    path : str
        What it concerns, such as ``hands.left``.
    problem : str
        What is wrong with it.
    """

    kind: Kind
    path: str
    problem: str


@dataclass
class _Tally:
    problem: str  # the first
    place: str | None  # of the first
    count: int = 0


class DefectCounts:
    """Counts the defects of many messages, with the first problem of each path and its place."""

    def __init__(self) -> None:
        self._tallies: dict[tuple[str, str], _Tally] = {}

    def add(self, defect: Defect, place: str | None = None) -> None:
        """Count a defect that was found at a place, such as ``line 3``."""
        key = (defect.kind, defect.path)
        if key not in self._tallies and len(self._tallies) >= MAX_PLACES:
            key = (defect.kind, OTHERS)
        tally = self._tallies.setdefault(key, _Tally(defect.problem[:200], place))
        tally.count += 1

    def report(self) -> list[dict[str, Any]]:
        """Return the counts as plain data."""
        return [
            {"what": kind, "path": path, "count": t.count, "problem": t.problem, "first": t.place}
            for (kind, path), t in list(self._tallies.items())
        ]

    def lines(self) -> Iterator[str]:
        """Yield one sentence for each kind and path."""
        for (kind, path), tally in list(self._tallies.items()):
            times = "once" if tally.count == 1 else f"{tally.count} times"
            first = f", first in {tally.place}" if tally.place else ""
            yield f"{path}: {kind} {times}{first} ({tally.problem})"

    def __len__(self) -> int:
        return len(self._tallies)
