"""One-Euro filters of positions and orientations.

Casiez, Roussel & Vogel (2012), 1 € filter, CHI, https://doi.org/10.1145/2207676.2208639:
a first-order low-pass whose cutoff grows with speed, ``cutoff = min_cutoff + beta * |speed|``.
Here the speed is the norm of the derivative *vector*, so that results do not turn with the frame;
time comes from the data alone, so that a replay repeats bit for bit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Quaternion, Vector
from igrip.motion.one_euro_kernel import (
    begin,
    derivative_of,
    new_filter,
    place_point,
    point_of,
    quaternion_of,
    smoothing,
    step_orientation,
    step_pose,
    step_position,
    velocity_of,
)
from igrip.settings import Settings, quantity

__all__ = [
    "OneEuroConfig", "OrientationFilter", "PlacedPoint", "PoseFilter", "PositionFilter", "smoothing"
]  # fmt: skip

Array = NDArray[np.float64]


class OneEuroConfig(Settings):
    """Parameters of one filter; the unit of ``beta`` is Hz per unit of speed."""

    min_cutoff: float = quantity(
        1.5, "Hz", "cutoff at rest", "guess; the authors' code: 1 Hz", gt=0
    )
    beta: float = quantity(
        5.0, "Hz per m/s or rad/s", "growth with speed", "guess; 2-8 suit a reach", ge=0
    )
    derivative_cutoff: float = quantity(
        1.0, "Hz", "cutoff of the derivative that measures speed", "Casiez et al. 2012", gt=0
    )


class _Filter:
    """What the filters of points and rotations share: parameters and state.

    Attributes
    ----------
    state, parameters : (11,), (3,)
        Of :mod:`igrip.motion.one_euro_kernel`, which alone knows their layout.
    begun : bool
        Whether there was a sample.
    """

    def __init__(self, config: OneEuroConfig) -> None:
        self.state, self.parameters = new_filter(
            config.min_cutoff, config.beta, config.derivative_cutoff
        )
        self.begun = False

    @property
    def derivative(self) -> Vector:
        """What drives the cutoff: the low-passed step from the old value to the sample, over time.

        It holds the lag of the filter, so it is no velocity [m/s or rad/s].
        """
        return derivative_of(self.state)

    @property
    def velocity(self) -> Vector:
        """Low-passed velocity of the filtered value, world frame [m/s or rad/s]."""
        return velocity_of(self.state)


class PositionFilter(_Filter):
    """One-Euro filter of a point."""

    @property
    def value(self) -> Vector | None:
        """Filtered position [m]; None before the first sample."""
        return point_of(self.state) if self.begun else None

    def update(self, t: float, position: Vector) -> Vector:
        """Add a sample measured at ``t`` [s], later than the last; return the filtered point."""
        if not self.begun:
            begin(self.state, t, position)
            self.begun = True
            return position
        step_position(self.state, t, *position, self.parameters)
        return point_of(self.state)


class OrientationFilter(_Filter):
    """One-Euro filter on SO(3): angular speed in place of speed, slerp in place of blending."""

    @property
    def value(self) -> Quaternion | None:
        """Filtered rotation, unit quaternion x, y, z, w; None before the first sample."""
        return quaternion_of(self.state) if self.begun else None

    def update(self, t: float, orientation: Quaternion) -> Quaternion:
        """Add a sample measured at ``t`` [s], later than the last; return it filtered."""
        norm = math.hypot(*orientation)
        x, y, z, w = orientation
        unit = (x / norm, y / norm, z / norm, w / norm)
        if not self.begun:
            begin(self.state, t, unit)
            self.begun = True
            return unit
        step_orientation(self.state, t, *unit, self.parameters)
        return quaternion_of(self.state)


class PlacedPoint(NamedTuple):
    """A filtered pose, and a point that is fixed to it. World frame.

    Attributes
    ----------
    rotation, translation : (3, 3), (3,)
        The pose [m].
    point, velocity : (3,)
        The point and its velocity [m, m/s].
    """

    rotation: Array
    translation: Array
    point: Array
    velocity: Array


class PoseFilter:
    """A :class:`PositionFilter` and an :class:`OrientationFilter`, stepped in one call.

    Parameters
    ----------
    position, orientation : OneEuroConfig
        Their parameters.

    Attributes
    ----------
    begun : bool
        Whether there was a pose.
    """

    def __init__(self, position: OneEuroConfig, orientation: OneEuroConfig) -> None:
        self.position = PositionFilter(position)
        self.orientation = OrientationFilter(orientation)
        # side by side: each array costs a call from Python some time
        self._states = np.stack([self.position.state, self.orientation.state])
        self._parameters = np.stack([self.position.parameters, self.orientation.parameters])
        self.position.state, self.orientation.state = self._states
        self.begun = False

    def update(self, t: float, position: Vector, orientation: Quaternion) -> None:
        """Add a pose measured at ``t`` [s], later than the last."""
        if not self.begun:
            self.position.update(t, position)
            self.orientation.update(t, orientation)
            self.begun = True
            return
        step_pose(self._states, self._parameters, t, *position, *orientation)

    def place(self, local: Array, rest_speed: float) -> PlacedPoint:
        """Return the filtered pose as matrices, with a point and its velocity.

        Parameters
        ----------
        local : (3,)
            The point in the frame of the object [m].
        rest_speed : float
            A slower object rests: its velocity is zero [m/s].
        """
        out = np.empty((6, 3))
        place_point(self._states, local, rest_speed, out)
        return PlacedPoint(out[:3], *out[3:])
