"""What a commitment is decided on: the evidence of one hand after a message."""

from __future__ import annotations

import math
from collections.abc import Collection, Container, Mapping, Sequence
from typing import NamedTuple

from igrip.entities import Vector

NOTHING_HELD: Mapping[str, str] = {}  # no mapping proxy: evidence goes to other processes
MIN_CARRY_COSINE = 0.6  # between the velocities of a hand and of an object it carries; guess


class Evidence(NamedTuple):
    """What a commitment is decided on, after a message in which the hand was measured.

    Attributes
    ----------
    t : float
        Time of the message [s].
    measured : float
        Time of the hand's newest accepted measurement [s].
    position : 3 floats
        Of the palm, then [m].
    trusted : bool
        Whether a device may act on the hand's input.
    moving : bool
        Whether it is in a movement.
    target, grip : str or None
        Of the estimate.
    confidence : mapping of str to float
        Probability, or score, of each object; of probabilities that of ``none``, too.
    trusted_objects : container of str
        Objects that a device may act on.
    distances : mapping of str to float
        Of the palm from each known object [m].
    carried : collection of str
        Objects that move along with the hand.
    familiarity : float or None
        Of the movement, from 0 (strange) to 1; None: not known.
    held : mapping of str to str
        Objects that another hand holds, and which (:mod:`igrip.holding`).
    """

    t: float
    measured: float
    position: Vector
    trusted: bool
    moving: bool
    target: str | None
    grip: str | None
    confidence: Mapping[str, float]
    trusted_objects: Container[str]
    distances: Mapping[str, float]
    carried: Collection[str] = ()
    familiarity: float | None = None
    held: Mapping[str, str] = NOTHING_HELD


def carried_objects(
    velocities: Mapping[str, Sequence[float]], velocity: Sequence[float]
) -> list[str]:
    """Return the objects that move much as a hand does.

    Parameters
    ----------
    velocities : mapping of str to 3 floats
        Of the moving objects, by id [m/s].
    velocity : 3 floats
        Of the hand [m/s].
    """
    speed = math.hypot(*velocity)
    return [
        id for id, own in velocities.items()
        if sum(a * b for a, b in zip(own, velocity, strict=True))
        > MIN_CARRY_COSINE * speed * math.hypot(*own)
    ]  # fmt: skip
