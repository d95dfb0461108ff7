"""Follow one object from frame to frame: seen and fitted, hidden and kept, or gone.

Hidden is what something nearer covers: nothing is known of it, so it stays where it was, with the
time when it was last seen. Gone is what is seen through: farther things are measured where it was.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from igrip.vision.registration.clusters import LOWEST
from igrip.vision.registration.evidence import HIDDEN, MATCH, OUTSIDE, THROUGH
from igrip.vision.registration.fit import NO_UP, Fit, judged, refit
from igrip.vision.registration.near import points_near
from igrip.vision.registration.view import View

Array = NDArray[np.float64]
State = Literal["seen", "hidden", "gone"]

GATE = 0.03  # how far an object is looked for from one frame to the next [m]; 0.9 m/s at 30 Hz
STEPS = 5
MANY = 500  # points an object is fitted to
IN_SIGHT = 0.25  # share of its side that must be seen for it to count as seen; guess
AGREEING = 0.6  # agreement of what is seen with where it is, at least; guess
COVERED = 0.2  # a share hidden beyond that at the start: it is not moved if it still fits; guess
SEEN_THROUGH = 0.35  # share measured behind it, for it not to be there; guess
LIFTED = 0.015  # so far from where it rested it rests no more [m]


@dataclass(frozen=True, eq=False)
class Track:
    """An object that was found.

    Attributes
    ----------
    fit : Fit
        Where it is, in the frame of the table.
    t : float
        When it was last seen [s].
    hidden : float
        Share of it that was hidden when it was found: by what stands before it.
    state : str
        ``seen``, ``hidden`` or ``gone``, in the newest frame.
    doubts : int
        Frames in a row in which it seemed gone.
    """

    fit: Fit
    t: float
    hidden: float
    state: State = "seen"
    doubts: int = 0


DOUBTS = 2  # frames in a row before it is given up: a depth picture may flicker


def follow(track: Track, view: View, t: float) -> Track:
    """Look for an object near where it was.

    Parameters
    ----------
    track : Track
        Where it was.
    view : View
        The frame.
    t : float
        Its time [s].
    """
    here = judged(track.fit, view)
    if _agrees(here) and here.hidden > track.hidden + COVERED:
        # a hand or an arm is in front: what of it is in sight has not moved
        return replace(track, fit=here, t=t, state="seen", doubts=0)
    points, depths = nearby(track.fit, view)
    if len(points) >= 20:
        moved = refit(_resting_or_not(here), points, depths, view, GATE, STEPS)
        if _agrees(moved):
            return replace(track, fit=moved, t=t, state="seen", doubts=0)
    if _agrees(here):
        return replace(track, fit=here, t=t, state="seen", doubts=0)
    evidence = here.evidence
    if evidence[THROUGH] > SEEN_THROUGH and evidence[THROUGH] > evidence[MATCH]:
        doubts = track.doubts + 1
        return replace(track, state="gone" if doubts >= DOUBTS else "hidden", doubts=doubts)
    return replace(track, state="hidden", doubts=0)


def nearby(fit: Fit, view: View, many: int = MANY) -> tuple[Array, Array]:
    """Return measured points near a shape, in the frame of the table (n, 3), and their depths.

    There are about as many as asked for, seldom more than four times that.
    """
    shape = fit.shape
    away = view.camera_from_table[:3, :3] @ (fit.rotation @ shape.middle + fit.translation)
    z = max(0.1, float(away[2] + view.camera_from_table[2, 3]))
    pixels = (view.pinhole[0] * shape.radius / z) ** 2  # of its side, about
    stride = max(1, round(float(np.sqrt(pixels / many))))
    points, depths = np.empty((4 * many, 3)), np.empty(4 * many)
    count = points_near(
        view.depth, view.mask, view.pinhole, view.table_from_camera, fit.rotation, fit.translation,
        shape.middle, shape.radius, *shape.field, GATE, LOWEST - 0.004, view.spread, stride,
        points, depths,
    )  # fmt: skip
    return points[:count], depths[:count]


def _agrees(fit: Fit) -> bool:
    evidence = fit.evidence
    # what is hidden or out of the picture at the edge says nothing, for or against
    open_ = 1.0 - evidence[HIDDEN] - evidence[OUTSIDE]
    return bool(evidence[MATCH] >= IN_SIGHT * max(open_, 0.5) and fit.agreement >= AGREEING)


def _resting_or_not(fit: Fit) -> Fit:
    """Return the fit without its wish to rest on the table, if it was lifted off it."""
    height = float((fit.rotation @ fit.shape.middle + fit.translation)[2])
    lean = float(fit.rotation[2] @ fit.up)
    if fit.up.any() and (abs(height - fit.height) > LIFTED or lean < np.cos(np.radians(10.0))):
        return replace(fit, up=NO_UP)
    return fit
