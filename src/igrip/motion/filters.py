"""One-Euro filters of positions and orientations.

Casiez, Roussel & Vogel (2012), 1 € filter, CHI, https://doi.org/10.1145/2207676.2208639:
a first-order low-pass whose cutoff grows with speed, ``cutoff = min_cutoff + beta * |speed|``.
Here the speed is the norm of the derivative *vector*, so that results do not turn with the frame;
time comes from the data alone, so that a replay repeats bit for bit.
"""

from __future__ import annotations

import math

from igrip.entities import Quaternion, Vector
from igrip.motion import rotation
from igrip.settings import Settings, quantity


class OneEuroConfig(Settings):
    """Parameters of one filter; the unit of ``beta`` is Hz per unit of speed."""

    min_cutoff: float = quantity(1.5, "Hz", "cutoff at rest", "SPEC §2: 1-1.5 Hz", gt=0)
    beta: float = quantity(5.0, "Hz per m/s or rad/s", "growth with speed", "SPEC §2: 2-8", ge=0)
    derivative_cutoff: float = quantity(
        1.0, "Hz", "cutoff of the derivative that measures speed", "Casiez et al. 2012", gt=0
    )


def smoothing(cutoff: float, dt: float) -> float:
    """Return the weight of a new sample in a first-order low-pass (Casiez et al. 2012, eq. 5)."""
    tau = 1.0 / (2.0 * math.pi * cutoff)
    return 1.0 / (1.0 + tau / dt)


def _blend(old: Vector, new: Vector, weight: float) -> Vector:
    return (
        old[0] + weight * (new[0] - old[0]),
        old[1] + weight * (new[1] - old[1]),
        old[2] + weight * (new[2] - old[2]),
    )


class PositionFilter:
    """One-Euro filter of a point.

    Attributes
    ----------
    value : 3 floats or None
        Filtered position [m]; None before the first sample.
    derivative : 3 floats
        What drives the cutoff: the low-passed step from the filtered point to the new sample, over
        time [m/s]. It holds the lag of the filter, so it is no velocity.
    velocity : 3 floats
        Low-passed velocity of the filtered point [m/s].
    """

    def __init__(self, config: OneEuroConfig) -> None:
        self._config = config
        self._t = 0.0
        self.value: Vector | None = None
        self.derivative: Vector = (0.0, 0.0, 0.0)
        self.velocity: Vector = (0.0, 0.0, 0.0)

    def update(self, t: float, position: Vector) -> Vector:
        """Take a sample measured at ``t`` [s], later than the last; return the filtered point."""
        if self.value is None:
            self._t, self.value = t, position
            return position
        dt = t - self._t
        old = self.value
        raw = (
            (position[0] - old[0]) / dt,
            (position[1] - old[1]) / dt,
            (position[2] - old[2]) / dt,
        )
        weight = smoothing(self._config.derivative_cutoff, dt)
        self.derivative = _blend(self.derivative, raw, weight)
        cutoff = self._config.min_cutoff + self._config.beta * math.hypot(*self.derivative)
        part = smoothing(cutoff, dt)
        self.value = _blend(old, position, part)
        moved = (part * raw[0], part * raw[1], part * raw[2])
        self.velocity = _blend(self.velocity, moved, weight)
        self._t = t
        return self.value


class OrientationFilter:
    """One-Euro filter on SO(3): angular speed in place of speed, slerp in place of blending.

    Attributes
    ----------
    value : 4 floats or None
        Filtered rotation, unit quaternion x, y, z, w; None before the first sample.
    derivative : 3 floats
        What drives the cutoff, see :class:`PositionFilter`; world frame [rad/s].
    velocity : 3 floats
        Low-passed angular velocity of the filtered rotation, world frame [rad/s].
    """

    def __init__(self, config: OneEuroConfig) -> None:
        self._config = config
        self._t = 0.0
        self.value: Quaternion | None = None
        self.derivative: Vector = (0.0, 0.0, 0.0)
        self.velocity: Vector = (0.0, 0.0, 0.0)

    def update(self, t: float, orientation: Quaternion) -> Quaternion:
        """Take a sample measured at ``t`` [s], later than the last; return it filtered."""
        if self.value is None:
            self._t, self.value = t, rotation.normalise(orientation)
            return self.value
        dt = t - self._t
        step = rotation.logarithm(
            rotation.multiply(rotation.normalise(orientation), rotation.conjugate(self.value))
        )
        raw = (step[0] / dt, step[1] / dt, step[2] / dt)
        weight = smoothing(self._config.derivative_cutoff, dt)
        self.derivative = _blend(self.derivative, raw, weight)
        cutoff = self._config.min_cutoff + self._config.beta * math.hypot(*self.derivative)
        part = smoothing(cutoff, dt)
        turn = rotation.exponential((part * step[0], part * step[1], part * step[2]))
        self.value = rotation.normalise(rotation.multiply(turn, self.value))
        moved = (part * raw[0], part * raw[1], part * raw[2])
        self.velocity = _blend(self.velocity, moved, weight)
        self._t = t
        return self.value
