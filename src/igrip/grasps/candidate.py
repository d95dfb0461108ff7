"""A grasp candidate: one way to take one part of an object."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLEARANCE = 0.06  # m; from the palm's centre to what it meets, when a grasp closes: as simulated
ON_AXIS = 0.03  # m; a palm so near to a line is not moved by a turn about it


class Candidate(NamedTuple):
    """One way to grasp an object. In the frame of its mesh [m, rad].

    Attributes
    ----------
    grip : str
        Of :data:`igrip.taxonomy.GRIP_TYPES`.
    part : str
        ``body``, ``end``, ``neck``, ``handle``, ``rim``, ``knob``, or what the user calls it.
    point : (3,)
        Midway between the contacts.
    approach, closing : (3,)
        Unit vectors: the way of the palm to the point, and from the thumb to the fingers (the
        opposite is as good).
    opening : float
        Between the contacts.
    depth : float
        From where the palm meets the object to the point, along the approach.
    weight : float
        Its share of all hands that fit the object, as a prior.
    pivot, axis : (3,)
        A line about which the candidate may be turned as a whole; ``axis`` is a unit vector.
    turns : (float, float)
        From which to which turn; both 0: it may not.
    """

    grip: str
    part: str
    point: Array
    approach: Array
    closing: Array
    opening: float
    depth: float
    weight: float
    pivot: Array
    axis: Array
    turns: tuple[float, float] = (0.0, 0.0)

    @property
    def contacts(self) -> Array:
        """Where thumb and fingers press, shape (2, 3)."""
        half = 0.5 * self.opening * self.closing
        return np.stack([self.point - half, self.point + half])

    def turned(self, angle: float) -> Candidate:
        """Return the candidate turned about its line [rad]."""
        rotation = turn_about(self.axis, angle)
        return self._replace(
            point=self.pivot + rotation @ (self.point - self.pivot),
            approach=rotation @ self.approach, closing=rotation @ self.closing,
            turns=(self.turns[0] - angle, self.turns[1] - angle),
        )  # fmt: skip

    def turn_towards(self, other: Candidate) -> float:
        """Return the turn, of those allowed, that brings it nearest to another candidate [rad]."""
        return self.turn_to(other.palm(CLEARANCE), other.closing)

    def turn_to(self, palm: Array, closing: Array | None = None) -> float:
        """Return the turn, of those allowed, that brings its palm nearest to a place [rad].

        A palm on the line does not move: then the closing direction, if given, leads.
        """
        low, high = self.turns
        if high <= low:
            return 0.0
        own = across(self.axis, self.palm(CLEARANCE) - self.pivot)
        goal = across(self.axis, np.asarray(palm) - self.pivot)
        period = 2.0 * np.pi
        if np.linalg.norm(own) < ON_AXIS:
            if closing is None:
                return 0.0
            own, goal, period = across(self.axis, self.closing), across(self.axis, closing), np.pi
        if np.linalg.norm(own) < 1e-9 or np.linalg.norm(goal) < 1e-9:
            return 0.0
        angle = float(np.arctan2(self.axis @ np.cross(own, goal), own @ goal))
        every = angle + period * np.arange(-2, 3)
        off = np.maximum(low - every, 0.0) + np.maximum(every - high, 0.0)
        best = every[np.argmin(off + 1e-9 * np.abs(every))]
        return float(np.clip(best, low, high))

    def palm(self, clearance: float) -> Array:
        """Return where the palm is, ``clearance`` before what it meets, shape (3,) [m]."""
        palm: Array = self.point - (self.depth + clearance) * self.approach
        return palm


def across(axis: Array, vector: Array) -> Array:
    """Return the part of a vector across a unit axis, shape (3,)."""
    part: Array = vector - (vector @ axis) * axis
    return part


def turn_about(axis: Array, angle: float) -> Array:
    """Return the rotation by an angle [rad] about a unit axis, shape (3, 3) (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: Array = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)
    return rotation
