"""Which starts of a fit differ: a can looks alike however it is turned, a box from two sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.objects.stable_poses import StablePoses
from igrip.perception.registration.signed_distance import SignedDistanceField
from igrip.rgbd import Array

TURNS = np.arange(12) * (2.0 * np.pi / 12)  # about the vertical
ALIKE = 0.003  # poses are one if all but a tenth of the surface is so near to itself [m]; guess
SAME_HEIGHT = 0.006  # and their centres are about as high [m]


def distinct_starts(
    points: Array, centre: Array, field: SignedDistanceField, stable_poses: StablePoses
) -> NDArray[np.int64]:
    """Return the ways of resting and the turns (their numbers, (k, 2)) that look different.

    ``points`` (n, 3) are on the surface; they and the ``centre`` (3,), about which a mesh is
    turned, are in the frame of the mesh [m].
    """
    points = points - centre
    kept: list[tuple[int, int]] = []
    poses: list[tuple[Array, float]] = []
    for way, (rotation, height) in enumerate(
        zip(stable_poses.rotations, stable_poses.heights, strict=True)
    ):
        middle = float(height + rotation[2] @ centre)
        for turn, angle in enumerate(TURNS):
            c, s = np.cos(angle), np.sin(angle)
            pose = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ rotation
            for other, level in poses:
                if abs(level - middle) > SAME_HEIGHT:
                    continue
                there = (points @ pose.T + [0.0, 0.0, middle - level]) @ other + centre
                if np.percentile(np.abs(field.distances(there)), 90.0) < ALIKE:
                    break
            else:
                kept.append((way, turn))
                poses.append((pose, middle))
    return np.array(kept, dtype=np.int64).reshape(-1, 2)
