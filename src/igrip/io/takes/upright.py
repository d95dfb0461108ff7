"""Tracked bodies whose own axes are those of a world in which another axis than z points up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.io.frames import DeclaredFrame
from igrip.io.takes.take import Track


def with_upright_axes(track: Track, frame: DeclaredFrame) -> Track:
    """Return the track of a body whose axes were those of the file's world when it was not turned.

    The frame has turned the world alone. Here the body's own axes are turned back with it, so that
    a body that is not turned in the file is upright.
    """
    if track.orientations is None or frame.left_handed:
        return track
    turns = Rotation.from_quat(track.orientations) * Rotation.from_matrix(frame.matrix).inv()
    return replace(track, orientations=np.asarray(turns.as_quat()))
