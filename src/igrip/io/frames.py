"""The declared frame of data from elsewhere: axes, handedness, quaternion order and units.

Everything is converted at the edge, to metres, seconds, quaternions x, y, z, w and a right-handed
world with z up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from igrip.errors import IgripError

Array = NDArray[np.float64]

METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "in": 0.0254}
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
QUATERNION_ORDERS = ("xyzw", "wxyz")
HANDEDNESS = ("right", "left")

# igrip's x, y and z in terms of the source's axes, by the axis of the source that points up
AXES_BY_UP = {
    "z": ("x", "y", "z"), "-z": ("x", "-y", "-z"), "y": ("x", "-z", "y"), "-y": ("x", "z", "-y"),
    "x": ("y", "z", "x"), "-x": ("-y", "z", "-x"),
}  # fmt: skip
MIRROR = np.diag([-1.0, 1.0, 1.0])


class FrameError(IgripError, ValueError):
    """A declared frame contradicts itself, or a word in it is not known."""


@dataclass(frozen=True)
class DeclaredFrame:
    """What the numbers of a source mean.

    Parameters
    ----------
    axes : 3 str
        igrip's x, y and z in terms of the source's axes. ``("x", "-z", "y")``: igrip's y is the
        source's z reversed, and its z, which points up, is the source's y.
    left_handed : bool
        Whether the source's axes are left-handed (Unity, Unreal). The meshes are taken for mirrored
        along their x then, as Unity does when it imports them.
    quaternions : str
        Order of the components, ``"xyzw"`` or ``"wxyz"``.
    length_unit, time_unit : str
        A key of :data:`METRES`, of :data:`SECONDS`.

    Raises
    ------
    FrameError
        If a word is not known or the axes are not perpendicular.
    """

    axes: tuple[str, str, str] = ("x", "y", "z")
    left_handed: bool = False
    quaternions: str = "xyzw"
    length_unit: str = "m"
    time_unit: str = "s"

    def __post_init__(self) -> None:
        _check("quaternions", self.quaternions, QUATERNION_ORDERS)
        _check("length_unit", self.length_unit, METRES)
        _check("time_unit", self.time_unit, SECONDS)
        mirrored = np.linalg.det(self.matrix) < 0
        if mirrored != self.left_handed:
            is_left = "left" if mirrored else "right"
            raise FrameError(
                f"axes {','.join(self.axes)} are those of a {is_left}-handed source: declare "
                f'handedness = "{is_left}", or reverse the sign of one axis'
            )

    @classmethod
    def declare(
        cls,
        up: str | None = None,
        axes: Sequence[str] | str | None = None,
        handedness: str | None = None,
        quaternions: str = "xyzw",
        length_unit: str = "m",
        time_unit: str = "s",
    ) -> DeclaredFrame:
        """Build a frame from the words of a command line, a column map or ``dataset.json``.

        Parameters
        ----------
        up : str, optional
            The source's axis that points up, ``"y"`` or ``"-z"``; in place of ``axes``.
        axes : 3 str, or one with commas, optional
            As of the class.
        handedness : str, optional
            ``"right"`` or ``"left"``; by default what ``axes`` imply, or right.
        quaternions, length_unit, time_unit : str
            As of the class.
        """
        if up is not None and axes is not None:
            raise FrameError("declare either up or axes, not both")
        if handedness is not None:
            _check("handedness", handedness, HANDEDNESS)
        if axes is None:
            chosen = AXES_BY_UP[_check("up", "z" if up is None else up.lower(), AXES_BY_UP)]
            if handedness == "left":
                chosen = _reversed(chosen)
            return cls(chosen, handedness == "left", quaternions, length_unit, time_unit)
        parts = axes.split(",") if isinstance(axes, str) else list(axes)
        words = tuple(str(part).strip().lower().removeprefix("+") for part in parts)
        if len(words) != 3:
            raise FrameError(f"axes: must be three, such as x,-z,y; got {','.join(words)!r:.80}")
        first, second, third = words
        matrix = _matrix((first, second, third))
        left = np.linalg.det(matrix) < 0 if handedness is None else handedness == "left"
        return cls((first, second, third), bool(left), quaternions, length_unit, time_unit)

    @property
    def matrix(self) -> Array:
        """The world of igrip from the source's, without the unit; shape (3, 3)."""
        return _matrix(self.axes)

    @cached_property
    def is_default(self) -> bool:
        """Whether nothing has to be converted."""
        return self == DeclaredFrame()

    @property
    def seconds(self) -> float:
        """Length of the time unit [s]."""
        return SECONDS[self.time_unit]

    @property
    def metres(self) -> float:
        """Length of the length unit [m]."""
        return METRES[self.length_unit]

    def positions(self, positions: ArrayLike) -> Array:
        """Return positions (..., 3) in igrip's world [m]."""
        return self.metres * (np.asarray(positions, dtype=np.float64) @ self.matrix.T)

    def orientations(self, quaternions: ArrayLike) -> Array:
        """Return world-from-mesh quaternions (..., 4) as x, y, z, w in igrip's world.

        The mesh keeps the frame of its file: only the world turns. The norm is kept, so that one
        that is zero or not finite can still be recognised.
        """
        given = np.asarray(quaternions, dtype=np.float64)
        if self.quaternions == "wxyz":
            given = np.roll(given, -1, axis=-1)
        turn = self.matrix
        if self.left_handed:
            # A R M with M = diag(-1, 1, 1), which both mirror, is the product of the rotations A M
            # and M R M
            given = given * np.array([1.0, -1.0, -1.0, 1.0])
            turn = turn @ MIRROR
        return _turned(_quaternion_of(turn), given)

    def deviations(self, std: ArrayLike) -> Array:
        """Return standard deviations, one for all axes or (..., 3), in igrip's world [m]."""
        values = np.asarray(std, dtype=np.float64)
        return self.metres * (values if values.ndim == 0 else values @ np.abs(self.matrix).T)

    def times(self, times: ArrayLike) -> Array:
        """Return times [s]."""
        return self.seconds * np.asarray(times, dtype=np.float64)

    def to_dict(self) -> dict[str, Any]:
        """Return what was declared, as the keywords of :meth:`declare`."""
        return {
            "axes": list(self.axes), "handedness": HANDEDNESS[self.left_handed],
            "quaternions": self.quaternions, "length_unit": self.length_unit,
            "time_unit": self.time_unit,
        }  # fmt: skip


def _check(field: str, word: str, choices: Any) -> str:
    if word not in choices:
        raise FrameError(f"{field}: must be one of {', '.join(choices)}, got {word!r:.40}")
    return word


def _matrix(axes: tuple[str, str, str]) -> Array:
    matrix = np.zeros((3, 3))
    for row, word in enumerate(axes):
        column = "xyz".find(word.removeprefix("-")) if word else -1
        if len(word.removeprefix("-")) != 1 or column < 0:
            raise FrameError(f"axes: must be x, y, z or -x, -y, -z, got {word!r:.40}")
        matrix[row, column] = -1.0 if word.startswith("-") else 1.0
    if abs(np.linalg.det(matrix)) < 0.5:
        raise FrameError(f"axes: {','.join(axes)} name an axis twice")
    return matrix


def _reversed(axes: tuple[str, str, str]) -> tuple[str, str, str]:
    """Return axes of the other handedness with the same one up."""
    x, y, z = axes
    return x, y.removeprefix("-") if y.startswith("-") else f"-{y}", z


def _quaternion_of(rotation: Array) -> Array:
    """Return x, y, z, w of a proper rotation."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_quat())


def _turned(turn: Array, quaternions: Array) -> Array:
    """Return the Hamilton product of one quaternion with others (..., 4), x, y, z, w."""
    a, b = turn, quaternions
    vector = a[3] * b[..., :3] + b[..., 3:] * a[:3] + np.cross(a[:3], b[..., :3])
    scalar = a[3] * b[..., 3] - b[..., :3] @ a[:3]
    return np.concatenate([vector, scalar[..., None]], axis=-1)
