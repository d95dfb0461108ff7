"""Follow one object from frame to frame: seen and fitted, hidden and kept, or gone.

Hidden is what something nearer covers: nothing is known of it, so it stays where it was, with the
time when it was last seen. Gone is what is seen through: farther things are measured where it was.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from igrip.perception.registration.clusters import LOWEST
from igrip.perception.registration.crop import points_near
from igrip.perception.registration.fit import NO_UP, Fit, judged, refit
from igrip.perception.registration.view import View
from igrip.perception.registration.visibility import HIDDEN, MATCH, OUTSIDE, THROUGH

Array = NDArray[np.float64]
State = Literal["seen", "hidden", "gone"]

GATE = 0.03  # how far an object is looked for from one frame to the next [m]; 0.9 m/s at 30 Hz
STEPS = 8
STILL = 0.004  # what would move less until now is looked for where it was alone [m]
LOOK_AHEAD = 0.1  # for no longer than that does it go on as before [s]; guess
MANY = 500  # points an object is fitted to
IN_SIGHT = 0.25  # share of its side that must be seen for it to count as seen; guess
AGREEING = 0.6  # agreement of what is seen with where it is, at least; guess
COVERED = 0.2  # a share hidden beyond that at the start: it is not moved if it still fits; guess
SEEN_THROUGH = 0.35  # share measured behind it, for it not to be there; guess
LIFTED = 0.015  # so far from where it rested it rests no more [m]
CLEARLY = 0.02  # of two fits the first is kept unless the agreement of the other is so much better


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
    velocity : (3,)
        Of its middle, in the frame of the table [m/s].
    """

    fit: Fit
    t: float
    hidden: float
    state: State = "seen"
    doubts: int = 0
    velocity: Array = field(default_factory=lambda: np.zeros(3))


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
    best: Fit | None = None
    for start in _starts(track, here, t):
        points, depths = nearby(start, view)
        if len(points) >= 20:
            moved = refit(start, points, depths, view, GATE, STEPS)
            better = best is None or moved.agreement > best.agreement + CLEARLY
            if _agrees(moved) and better:
                best = moved
        if best is not None and best.agreement > track.fit.agreement - CLEARLY:
            break  # as good as before: no need to look further
    if best is not None:
        best = replace(best, up=track.fit.up)
        velocity = _velocity(track, best, t)
        return replace(track, fit=best, t=t, state="seen", doubts=0, velocity=velocity)
    if _agrees(here):
        return replace(track, fit=here, t=t, state="seen", doubts=0)
    evidence = here.evidence
    if evidence[THROUGH] > SEEN_THROUGH and evidence[THROUGH] > evidence[MATCH]:
        doubts = track.doubts + 1
        return replace(track, state="gone" if doubts >= DOUBTS else "hidden", doubts=doubts)
    return replace(track, state="hidden", doubts=0)


def _starts(track: Track, here: Fit, t: float) -> list[Fit]:
    """Return where to look: where it was, resting and free, and where it would be by now."""
    starts = [here] if _rests(here) else []
    free = replace(here, up=NO_UP)
    shift = track.velocity * min(max(t - track.t, 0.0), LOOK_AHEAD)
    if np.linalg.norm(shift) > STILL:
        starts.append(replace(free, translation=here.translation + shift))
    starts.append(free)
    return starts


def _velocity(track: Track, fit: Fit, t: float) -> Array:
    """Return the velocity of the middle after a new fit [m/s]."""
    if not t > track.t:
        return track.velocity
    before = track.fit.rotation @ fit.shape.middle + track.fit.translation
    now: Array = (fit.rotation @ fit.shape.middle + fit.translation - before) / (t - track.t)
    return 0.3 * track.velocity + 0.7 * now


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


def _rests(fit: Fit) -> bool:
    """Whether a fit is about where it would be if it rested on the table."""
    height = float((fit.rotation @ fit.shape.middle + fit.translation)[2])
    lean = float(fit.rotation[2] @ fit.up)
    return abs(height - fit.height) < LIFTED and lean > np.cos(np.radians(10.0))
