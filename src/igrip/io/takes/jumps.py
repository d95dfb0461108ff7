"""Steps that no hand can make: named, for a person to look at."""

from __future__ import annotations

import numpy as np

from igrip.io.takes.take import Track

MAX_SPEED = 15.0  # m/s; a fast throw has about 10
MIN_STEP = 0.05  # m; shorter ones are noise


def jump_remark(track: Track) -> str | None:
    """Return a remark on the steps of a track that are too fast, with the place of the first."""
    if len(track.times) < 2:
        return None
    steps = np.linalg.norm(np.diff(track.positions, axis=0), axis=1)
    intervals = np.diff(track.times)
    fast = np.flatnonzero((steps > MAX_SPEED * intervals) & (steps > MIN_STEP))
    if not len(fast):
        return None
    k = int(fast[0])
    return (
        f"{len(fast)} steps that no hand can make, first {steps[k]:.2f} m in {intervals[k]:.3g} s "
        f"at {track.times[k + 1]:.3f} s"
    )
