"""Which axis points up: of tracked bodies, and of a scene where another one than z seems to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.io.frames import DeclaredFrame
from igrip.io.takes.take import Track

Array = NDArray[np.float64]
MAX_HEIGHT = 0.15  # m between all that happens on a table
MIN_SPAN = 0.25  # m that the scene spans along the other axes
MIN_STEP = 0.05  # m between the heights of objects that stand on different places


def upright_remark(hand: Array, objects: Sequence[Array]) -> str | None:
    """Return a remark where hand and objects stay at one height along y or x, but not along z.

    Parameters
    ----------
    hand : (n, 3)
        Positions [m].
    objects : sequence of (3,)
        Places [m], at least two.
    """
    if len(objects) < 2 or not len(hand):
        return None
    places = np.array(objects)
    spans = np.ptp(np.vstack([hand, places]), axis=0)
    if spans[2] < MIN_SPAN or np.ptp(places[:, 2]) < MIN_STEP:
        return None
    for axis, name in ((1, "y"), (0, "x")):
        other = spans[1 - axis]
        if spans[axis] < MAX_HEIGHT and other > MIN_SPAN:
            return (
                f"everything stays within {spans[axis]:.2f} m along {name} and spans "
                f'{spans[2]:.2f} m along z: if {name} points up, declare up = "{name}"'
            )
    return None


def with_upright_axes(track: Track, frame: DeclaredFrame) -> Track:
    """Return the track of a body whose axes were those of the file's world when it was not turned.

    The frame has turned the world alone. Here the body's own axes are turned back with it, so that
    a body that is not turned in the file is upright.
    """
    if track.orientations is None or frame.left_handed:
        return track
    turns = Rotation.from_quat(track.orientations) * Rotation.from_matrix(frame.matrix).inv()
    return replace(track, orientations=np.asarray(turns.as_quat()))
