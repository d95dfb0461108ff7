"""The palm of a MANO hand from its root: where a set gives parameters instead of joints."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.io.takes.take import Array

# of the mean right hand in the frame of its template [m], Romero, Tzionas & Black 2017; a person's
# own hand differs by up to 2 cm. The left hand is its mirror image.
WRIST = np.array([0.096, 0.006, 0.006])
PALM = np.array([0.050, 0.006, 0.006])


def palms(translations: Array, rotations: Array, side: str) -> Array:
    """Return palm centres (n, 3) [m].

    The root turns about the wrist of the template, which is then moved.

    Parameters
    ----------
    translations : (n, 3)
        Of the model [m].
    rotations : (n, 3)
        Global orientations, axis times angle [rad].
    side : str
        ``left`` or ``right``.
    """
    mirror = np.array([-1.0, 1.0, 1.0]) if side == "left" else np.ones(3)
    turned = Rotation.from_rotvec(rotations).apply(mirror * (PALM - WRIST))
    found: Array = translations + mirror * WRIST + turned
    return found
