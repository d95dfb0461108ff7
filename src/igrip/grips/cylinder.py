"""The paper's rule: beside the body of an object palmar, at its ends pinch (Eqs. 11, 12)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import Geometry
from igrip.grips import GRIPS, Grip, GripConfig
from igrip.motion.trajectory import Motion
from igrip.targets import TargetEstimate


def is_pinch(
    axial: NDArray[np.float64], half_length: NDArray[np.float64], pinch_threshold: float
) -> NDArray[np.bool_]:
    """Return whether a hand at z = ``axial`` of the object frame pinches.

    ``|z| >= 0.85 · half-length``. The paper compares with the full length of the cylinder, which
    would put the border outside the object, against its own Figure 2 (decision 0013).
    """
    return np.abs(axial) >= pinch_threshold * half_length


@GRIPS.register("cylinder")
class CylinderGrip:
    """Selects by the present position of the hand along the axis of its target."""

    def __init__(self, config: GripConfig) -> None:
        self._pinch_threshold = config.pinch_threshold

    def select(self, estimate: TargetEstimate, geometry: Geometry, motion: Motion) -> Grip:
        """Return the grip for the target, none without one."""
        if estimate.target is None:
            return Grip(None)
        axial = geometry.axial[estimate.target]
        pinch = is_pinch(axial, geometry.half_length[estimate.target], self._pinch_threshold)
        return Grip("pinch" if pinch else "palmar")
