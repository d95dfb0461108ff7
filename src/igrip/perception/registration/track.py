"""Follow one object from frame to frame: visible and fitted, hidden and kept, or gone.

An object is hidden where something nearer covers it: it keeps its pose, and the time when it was
last visible. It is gone where farther surfaces are measured in its place. What a hand holds moves
with the hand, visible or not.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from igrip.perception.registration.align import Annealing
from igrip.perception.registration.crop import GATE, points_near
from igrip.perception.registration.fit import PoseFit, rated, refit
from igrip.perception.registration.view import DepthView
from igrip.rgbd import Array

State = Literal["visible", "hidden", "gone"]

ANNEALING = Annealing(GATE, 0.0, 8)
MIN_SHIFT = 0.004  # what would move less until now is looked for where it was alone [m]
MAX_LOOK_AHEAD = 0.1  # for no longer than that does it go on as before [s]; guess
POINTS = 500  # an object is fitted to
MIN_POINTS = 20
MIN_VISIBLE = 0.25  # share of its side that must be visible; guess
MIN_AGREEMENT = 0.6  # of what is visible with where it is; guess
COVERED = 0.2  # a share hidden beyond that at the start: it is not moved if it still fits; guess
SEEN_THROUGH = 0.35  # share measured behind it, for it not to be there; guess
MAX_GONE_HELD = 10  # the same of what a hand holds; guess
MOVES = 0.002  # by which a hand moves in a frame that does not rest [m]; guess
MAX_GONE = 2  # frames in a row before it is given up: a depth picture may flicker
LIFTED = 0.015  # so far from where it rested it rests no more [m]
MIN_UPRIGHT = np.cos(np.radians(10.0))  # nor if it leans more
CLEARLY = 0.02  # of two fits the first is kept unless the agreement of the other is so much better


@dataclass(frozen=True, eq=False)
class DepthTrack:
    """An object that was found."""

    fit: PoseFit  # where it is, in the frame of the table
    t: float  # when it was last visible [s]
    hidden: float  # share of it that was hidden when it was found: by what stands before it
    state: State = "visible"  # in the newest frame
    gone_for: int = 0  # frames in a row in which it seemed gone
    velocity: Array = field(default_factory=lambda: np.zeros(3))  # of its centre [m/s]
    carried: bool = False  # whether it moved with the hand that is at it

    def update(self, view: DepthView, t: float, hand: Array | None = None) -> DepthTrack:
        """Return the track after a frame of time ``t`` [s].

        ``hand``: by which the hand at it moved since the former frame, (3,) [m]; None: there is
        none at it.
        """
        here = rated(self.fit, view)
        agrees = _agrees(here)
        led = hand is not None and (self.carried or float(np.linalg.norm(hand)) > MOVES)
        if agrees and here.hidden > self.hidden + COVERED and not led:
            # a hand or an arm is in front: the part of it that is visible has not moved
            return replace(self._visible(here, t), carried=self.carried and hand is not None)
        best = self._best_fit(here, view, t, hand if led else None)
        if best is not None and not (led and agrees and _is_no_better(best, here)):
            best = replace(best, resting=self.fit.resting)
            moved = float(np.linalg.norm(best.centre - self.fit.centre)) > MIN_SHIFT
            carried = hand is not None and (self.carried or moved)
            seen = replace(self._visible(best, t), carried=carried)
            return replace(seen, velocity=self._velocity_to(best, t))
        if agrees:
            return replace(self._visible(here, t), carried=False)
        return self._unseen(here, view, hand)

    def _unseen(self, here: PoseFit, view: DepthView, hand: Array | None) -> DepthTrack:
        """Return the track after a frame in which it was not found."""
        through = _is_seen_through(here)
        carried = hand is not None and (self.carried or through)
        if carried and hand is not None:
            pose = here.pose._replace(translation=here.pose.translation + hand)
            here = rated(replace(here, pose=pose), view)
            through = _is_seen_through(here)
        kept = replace(self, carried=carried, fit=here if carried else self.fit)
        if not through:
            return replace(kept, state="hidden", gone_for=0)
        gone_for = self.gone_for + 1
        state: State = "gone" if gone_for >= (MAX_GONE_HELD if carried else MAX_GONE) else "hidden"
        return replace(kept, state=state, gone_for=gone_for)

    def _visible(self, fit: PoseFit, t: float) -> DepthTrack:
        return replace(self, fit=fit, t=t, state="visible", gone_for=0)

    def _best_fit(
        self, here: PoseFit, view: DepthView, t: float, hand: Array | None
    ) -> PoseFit | None:
        """Return the best fit that agrees, from where it was or would be by now."""
        best: PoseFit | None = None
        for start in self._starts(here, t, hand):
            points, depths = points_near(view, start.pose, start.shape.surface, POINTS)
            if len(points) >= MIN_POINTS:
                fit = refit(start, points, depths, view, ANNEALING)
                better = best is None or fit.agreement > best.agreement + CLEARLY
                if _agrees(fit) and better:
                    best = fit
            if best is not None and best.agreement > self.fit.agreement - CLEARLY:
                break  # as good as before: no need to look further
        return best

    def _starts(self, here: PoseFit, t: float, hand: Array | None) -> list[PoseFit]:
        """Return where it was, resting and free, and where it would be by now."""
        free = replace(here, resting=here.resting._replace(weight=0.0))
        starts = [here] if _rests(here) and not self.carried else []
        shifts = [] if hand is None else [hand]
        shifts.append(self.velocity * min(max(t - self.t, 0.0), MAX_LOOK_AHEAD))
        for shift in shifts:
            if np.linalg.norm(shift) > MIN_SHIFT:
                pose = here.pose._replace(translation=here.pose.translation + shift)
                starts.append(replace(free, pose=pose))
        starts.append(free)
        return starts

    def _velocity_to(self, fit: PoseFit, t: float) -> Array:
        """Return the velocity of the centre after a new fit [m/s]."""
        if not t > self.t:
            return self.velocity
        velocity: Array = (fit.centre - self.fit.centre) / (t - self.t)
        return 0.3 * self.velocity + 0.7 * velocity


def _agrees(fit: PoseFit) -> bool:
    # what is hidden or out of the picture is no evidence, for or against
    open_share = 1.0 - fit.visibility.hidden - fit.visibility.outside
    visible = fit.visibility.match >= MIN_VISIBLE * max(open_share, 0.5)
    return visible and fit.agreement >= MIN_AGREEMENT


def _is_seen_through(fit: PoseFit) -> bool:
    share = fit.visibility
    return share.through > SEEN_THROUGH and share.through > share.match


def _is_no_better(fit: PoseFit, here: PoseFit) -> bool:
    """Whether a fit agrees no better than where it was, of which more would have to be seen."""
    return fit.agreement < here.agreement + CLEARLY


def _rests(fit: PoseFit) -> bool:
    """Whether a fit is about where it would be if it rested on the table."""
    upright = float(fit.pose.rotation[2] @ fit.resting.up)
    return abs(float(fit.centre[2]) - fit.resting.height) < LIFTED and upright > MIN_UPRIGHT
