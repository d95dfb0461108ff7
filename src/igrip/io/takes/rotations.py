"""What files hold of a rotation, as unit quaternions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
MAX_NORM_ERROR = 0.05  # of a quaternion that is only rounded
MAX_MATRIX_ERROR = 0.05
MAX_NUMBER = 1e6  # of any kind of rotation, even degrees that are counted on over many turns


class Quaternions(NamedTuple):
    """Rotations of a body.

    Attributes
    ----------
    values : (n, 4)
        Unit quaternions x, y, z, w; NaN where there is no rotation.
    rounded : int
        How many were normalised by more than 0.5 %.
    """

    values: Array
    rounded: int


def quaternions(numbers: Array, kind: str, degrees: bool = True) -> Quaternions:
    """Return rotations as quaternions x, y, z, w.

    Parameters
    ----------
    numbers : (n, 3), (n, 4) or (n, 9)
        What the file holds.
    kind : str
        ``xyzw``, ``wxyz``; ``matrix``, column by column; ``rotvec``, axis times angle; or the axes
        of Euler angles as of scipy: ``XYZ`` turns about the body's own axes, ``xyz`` about the
        world's.
    degrees : bool
        Whether angles are in degrees.
    """
    numbers = np.where(np.abs(numbers) <= MAX_NUMBER, numbers, np.nan)
    values = np.full((len(numbers), 4), np.nan)
    good = np.isfinite(numbers).all(axis=1)
    rounded = 0
    if kind in ("xyzw", "wxyz"):
        given = np.roll(numbers, -1, axis=1) if kind == "wxyz" else numbers
        norm = np.linalg.norm(given, axis=1)
        good &= np.abs(norm - 1.0) <= MAX_NORM_ERROR
        rounded = int((np.abs(norm[good] - 1.0) > 5e-3).sum())
        values[good] = given[good] / norm[good, None]
    elif kind == "matrix":
        matrices = numbers.reshape(-1, 3, 3).transpose(0, 2, 1)
        off = np.abs(matrices @ matrices.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
        good &= (off <= MAX_MATRIX_ERROR) & (np.linalg.det(np.nan_to_num(matrices)) > 0)
        if good.any():
            values[good] = Rotation.from_matrix(matrices[good]).as_quat()
    elif kind == "rotvec":
        angles = np.radians(numbers) if degrees else numbers
        if good.any():
            values[good] = Rotation.from_rotvec(angles[good]).as_quat()
    elif good.any():
        values[good] = Rotation.from_euler(kind, numbers[good], degrees=degrees).as_quat()
    return Quaternions(values, rounded)
