"""Which bodies of a take are hands and which are objects, by their names."""

from __future__ import annotations

from igrip.io.hand_ids import is_hand, side_of
from igrip.io.takes.take import Take


def hands_of(take: Take) -> dict[str, str]:
    """Return the bodies that are hands by their names, by id; rigid bodies before markers."""
    named = [key for key in take.tracks if is_hand(key)]
    rigid = [key for key in named if take.kinds[key] != "marker"] or named
    found: dict[str, str] = {}
    for key in rigid:
        found.setdefault(side_of(key) or "right", key)
    return found


def objects_of(take: Take) -> dict[str, str]:
    """Return the bodies that are no hands: the rigid ones, or all if none is rigid."""
    others = [key for key in take.tracks if not is_hand(key) and key]
    turning = [key for key in others if take.tracks[key].orientations is not None]
    return {key: key for key in turning or others if len(take.tracks[key].times)}
