"""Names of grips, after the GRASP taxonomy (Feix et al. 2016, IEEE Trans. Human-Mach. Syst. 46:66).

The paper knows two grips, ``palmar`` and ``pinch``; they keep their names and stand for the large
diameter grasp and the pad of thumb and index. The others are those a table of everyday objects
needs. A device that cannot do a grip does the first of its ``nearest`` that it can.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

Family = Literal["power", "precision"]


class GripType(NamedTuple):
    """One grip.

    Attributes
    ----------
    name : str
        As messages and configurations have it.
    feix : tuple of int
        Numbers of the GRASP taxonomy's grasps that it stands for.
    family : str
        ``power``: the palm takes part; ``precision``: the fingers alone.
    meaning : str
        In one line.
    nearest : tuple of str
        What stands in for it, the nearest first; at last a grip of the paper's two.
    """

    name: str
    feix: tuple[int, ...]
    family: Family
    meaning: str
    nearest: tuple[str, ...]


_TYPES = (
    GripType("palmar", (1, 10), "power", "the whole hand round a thick body (over 50 mm)",
             ("medium_wrap", "power_sphere", "hook", "pinch")),
    GripType("medium_wrap", (2, 3), "power", "the whole hand round a body of 18 to 50 mm",
             ("palmar", "hook", "power_sphere", "pinch")),
    GripType("power_sphere", (11, 26), "power", "the whole hand round a ball",
             ("palmar", "medium_wrap", "tripod", "pinch")),
    GripType("hook", (15,), "power", "the fingers through a handle",
             ("medium_wrap", "palmar", "lateral", "pinch")),
    GripType("tripod", (14, 27), "precision", "thumb, index and middle finger on a small knob",
             ("pinch", "lateral", "palmar")),
    GripType("pinch", (8, 9, 24), "precision", "thumb against the tips of the fingers",
             ("tripod", "lateral", "palmar")),
    GripType("lateral", (16,), "precision", "thumb against the side of the index finger",
             ("pinch", "tripod", "palmar")),
    GripType("flat", (22,), "precision", "thumb against straight fingers, for plates",
             ("lateral", "pinch", "palmar")),
)  # fmt: skip

GRIP_TYPES: Mapping[str, GripType] = MappingProxyType({grip.name: grip for grip in _TYPES})
NAMES = tuple(GRIP_TYPES)
PAPER_GRIP: Mapping[Family, str] = MappingProxyType({"power": "palmar", "precision": "pinch"})
"""The paper's grip of each family (its Figure 2)."""


def stand_in(grip: str, able: Collection[str], order: Collection[str] = ()) -> str | None:
    """Return which of the grips that a device is able to do stands for a grip.

    Parameters
    ----------
    grip : str
        What is asked for; one that no taxonomy knows has no stand-in but itself.
    able : collection of str
        What the device can do.
    order : collection of str, optional
        Tried before the order of the taxonomy.

    Returns
    -------
    str or None
        None: it can do neither this nor anything that stands for it.

    Examples
    --------
    >>> stand_in("tripod", ("palmar", "pinch"))
    'pinch'
    """
    known = GRIP_TYPES.get(grip)
    tried = (grip, *order, *(known.nearest if known else ()))
    return next((name for name in tried if name in able), None)


def paper_grip(grip: str) -> str:
    """Return the paper's grip, ``palmar`` or ``pinch``, of a grip's family."""
    return PAPER_GRIP[GRIP_TYPES[grip].family]
