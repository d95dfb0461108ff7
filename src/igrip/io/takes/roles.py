"""Which bodies of a take are hands and which are objects, by their names."""

from __future__ import annotations

from igrip.io.hand_ids import is_hand, side_of
from igrip.io.takes.take import Take

MAX_MARKERS = 10  # of a take of markers alone that are taken for objects; more are a person's
_WHOLE = ("hand", "palm", "wrist", "fist", "glove")  # before single fingers


def hands_of(take: Take) -> dict[str, str]:
    """Return the bodies that are hands by their names, by id.

    Rigid bodies come before markers, and whole hands before fingers.
    """
    named = [key for key in take.tracks if _is_hand(key)]
    rigid = [key for key in named if take.kinds[key] != "marker"] or named
    rigid.sort(key=lambda key: not any(word in key.lower() for word in _WHOLE))
    found: dict[str, str] = {}
    for key in rigid:
        found.setdefault(side_of(key) or side_of(_last(key)) or "right", key)
    return found


def objects_of(take: Take) -> dict[str, str]:
    """Return the bodies that are objects, by id: the rigid ones, or markers if none is rigid.

    The bones of a skeleton are no objects, nor are the markers of a whole person.
    """
    others = [key for key in take.tracks if key and not _is_hand(key)]
    others = [key for key in others if take.kinds[key] != "bone" and len(take.tracks[key].times)]
    turning = [key for key in others if take.tracks[key].orientations is not None]
    if not turning and len(others) > MAX_MARKERS:
        return {}
    return {"object" if key == "none" else key: key for key in turning or others}


def _is_hand(key: str) -> bool:
    return is_hand(key) or is_hand(_last(key))


def _last(key: str) -> str:
    """Return a body's name without that of its skeleton: ``Anna:RHand`` is ``RHand``."""
    return key.rpartition(":")[2]
