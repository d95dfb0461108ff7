"""One-Euro filters of positions and orientations.

Casiez, Roussel & Vogel (2012), 1 € filter, CHI, https://doi.org/10.1145/2207676.2208639:
a first-order low-pass whose cutoff grows with speed, ``cutoff = min_cutoff + beta * |speed|``.
Here the speed is the norm of the derivative *vector*, so that results do not turn with the frame;
time comes from the data alone, so that a replay repeats bit for bit.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.entities import Quaternion, Vector
from igrip.motion import one_euro_kernel as low_pass
from igrip.motion.one_euro_kernel import smoothing
from igrip.settings import Settings, quantity

__all__ = ["OneEuroConfig", "OrientationFilter", "PoseFilter", "PositionFilter", "smoothing"]


class OneEuroConfig(Settings):
    """Parameters of one filter; the unit of ``beta`` is Hz per unit of speed."""

    min_cutoff: float = quantity(1.5, "Hz", "cutoff at rest", "SPEC §2: 1-1.5 Hz", gt=0)
    beta: float = quantity(5.0, "Hz per m/s or rad/s", "growth with speed", "SPEC §2: 2-8", ge=0)
    derivative_cutoff: float = quantity(
        1.0, "Hz", "cutoff of the derivative that measures speed", "Casiez et al. 2012", gt=0
    )


class _Filter:
    """What the filters of points and rotations share: parameters and state.

    Attributes
    ----------
    parameters : (3,) float64
        Cutoff at rest [Hz], its growth, cutoff of the derivative [Hz].
    state : (11,) float64
        As :mod:`igrip.motion.one_euro_kernel` lays it out.
    begun : bool
        Whether there was a sample.
    """

    def __init__(self, config: OneEuroConfig) -> None:
        self.parameters = np.array([config.min_cutoff, config.beta, config.derivative_cutoff])
        self.state: NDArray[np.float64] = np.zeros(low_pass.STATE)
        self.begun = False

    def _begin(self, t: float, value: tuple[float, ...]) -> None:
        self.state[: len(value)] = value
        self.state[low_pass.TIME] = t
        self.begun = True

    @property
    def derivative(self) -> Vector:
        """What drives the cutoff: the low-passed step from the old value to the sample, over time.

        It holds the lag of the filter, so it is no velocity [m/s or rad/s].
        """
        x, y, z = self.state[low_pass.DERIVATIVE : low_pass.DERIVATIVE + 3].tolist()
        return (x, y, z)

    @property
    def velocity(self) -> Vector:
        """Low-passed velocity of the filtered value, world frame [m/s or rad/s]."""
        x, y, z = self.state[low_pass.VELOCITY : low_pass.VELOCITY + 3].tolist()
        return (x, y, z)


class PositionFilter(_Filter):
    """One-Euro filter of a point."""

    @property
    def value(self) -> Vector | None:
        """Filtered position [m]; None before the first sample."""
        if not self.begun:
            return None
        x, y, z = self.state[:3].tolist()
        return (x, y, z)

    def update(self, t: float, position: Vector) -> Vector:
        """Take a sample measured at ``t`` [s], later than the last; return the filtered point."""
        if not self.begun:
            self._begin(t, position)
            return position
        low_pass.step_position(self.state, t, *position, self.parameters)
        x, y, z = self.state[:3].tolist()
        return (x, y, z)


class OrientationFilter(_Filter):
    """One-Euro filter on SO(3): angular speed in place of speed, slerp in place of blending."""

    @property
    def value(self) -> Quaternion | None:
        """Filtered rotation, unit quaternion x, y, z, w; None before the first sample."""
        if not self.begun:
            return None
        x, y, z, w = self.state[:4].tolist()
        return (x, y, z, w)

    def update(self, t: float, orientation: Quaternion) -> Quaternion:
        """Take a sample measured at ``t`` [s], later than the last; return it filtered."""
        norm = math.hypot(*orientation)
        x, y, z, w = orientation
        x, y, z, w = x / norm, y / norm, z / norm, w / norm
        if not self.begun:
            self._begin(t, (x, y, z, w))
            return (x, y, z, w)
        low_pass.step_orientation(self.state, t, x, y, z, w, self.parameters)
        x, y, z, w = self.state[:4].tolist()
        return (x, y, z, w)


class PoseFilter:
    """A :class:`PositionFilter` and an :class:`OrientationFilter`, stepped in one call.

    Parameters
    ----------
    position, orientation : OneEuroConfig
        Their parameters.
    """

    def __init__(self, position: OneEuroConfig, orientation: OneEuroConfig) -> None:
        self.position = PositionFilter(position)
        self.orientation = OrientationFilter(orientation)

    def update(self, t: float, position: Vector, orientation: Quaternion) -> None:
        """Take a pose measured at ``t`` [s], later than the last."""
        if not self.position.begun:
            self.position.update(t, position)
            self.orientation.update(t, orientation)
            return
        low_pass.step_pose(
            self.position.state, self.orientation.state, t, *position, *orientation,
            self.position.parameters, self.orientation.parameters,
        )  # fmt: skip
