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
from igrip.perception.registration.hand_motion import MovingHand
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
MOVES = 0.05  # of a hand that does not rest [m/s]; guess
WELL = 0.35  # share of its side that must be visible to say that it slips in the hand; guess
BARELY = 0.18  # and with less of what moves with a hand it is not visible; guess
SLIPS = 0.025  # if less than WELL is visible, it does not slip farther [m]; guess
LATE = 0.03  # s by which landmarks of hands may be late; guess
MIN_TAKEN = 0.01  # what is hidden goes with the hand that rested at it from here on [m]; guess
MORE = 0.04  # share of its side by which evidence must be better for it to have moved; guess
ALONG, ASIDE = 0.3, 0.5  # what begins to move with a hand goes so far along, and aside; guess
JITTER = 0.006  # of a fit [m]; guess
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
    led: Array = field(default_factory=lambda: np.zeros(3))  # way of the hand since it rested [m]
    sure: Array | None = None  # its centre when it was well visible, carried on with the hand [m]
    grasped: bool = False  # whether that hand has rested at it
    left: PoseFit | None = None  # where it was before it moved unseen with the hand

    def update(self, view: DepthView, t: float, hand: MovingHand | None = None) -> DepthTrack:
        """Return the track after a frame of time ``t`` [s]; ``hand`` is the one that is at it."""
        here = rated(self.fit, view)
        agrees = _agrees(here)
        moves = hand is not None and (self.carried or hand.speed > MOVES)
        before = self._led(hand)
        if agrees and here.hidden > self.hidden + COVERED and not moves:
            # a hand or an arm is in front: the part of it that is visible has not moved
            return before._visible(here, t, hand)
        best = self._best_fit(here, view, t, hand if moves else None)
        if best is not None and hand is not None and moves:
            likely = before._is_likely(best, here if agrees else None, hand)
            best = best if likely else None
        if best is not None:
            best = replace(best, resting=self.fit.resting)
            moved = float(np.linalg.norm(best.centre - self.fit.centre)) > MIN_SHIFT
            seen = before._visible(best, t, hand)
            carried = hand is not None and (self.carried or (moves and moved))
            return replace(seen, velocity=self._velocity_to(best, t), carried=carried)
        if agrees and not self.carried:
            return before._visible(here, t, hand)
        return before._unseen(here, view, hand)

    def _led(self, hand: MovingHand | None) -> DepthTrack:
        """Return the track with the way of the hand at it, since that rested."""
        if hand is None:
            return replace(self, led=np.zeros(3), sure=None, carried=False, grasped=False)
        if hand.speed > MOVES:
            sure = None if self.sure is None else self.sure + hand.shift
            return replace(self, led=self.led + hand.shift, sure=sure)
        carried = self.carried and not _rests(self.fit)
        return replace(self, led=np.zeros(3), carried=carried, grasped=True)

    def _is_likely(self, fit: PoseFit, here: PoseFit | None, hand: MovingHand) -> bool:
        """Whether a fit beside a moving hand is the object, not the hand.

        ``here`` is where it was, if that agrees, too.
        """
        if self.carried:
            if self.sure is None or fit.visibility.match >= WELL:
                return True
            slipped = float(np.linalg.norm(fit.centre - self.sure))
            return fit.visibility.match >= BARELY and slipped < SLIPS + LATE * hand.speed
        if here is not None and _evidence(fit) < _evidence(here) + MORE:
            return False
        way = fit.centre - self.fit.centre
        share = float(way @ hand.shift) / max(float(hand.shift @ hand.shift), 1e-9)
        aside = float(np.linalg.norm(way - share * hand.shift))
        return share > ALONG and aside < ASIDE * float(np.linalg.norm(hand.shift)) + JITTER

    def _unseen(self, here: PoseFit, view: DepthView, hand: MovingHand | None) -> DepthTrack:
        """Return the track after a frame in which it was not found."""
        kept = self
        if hand is not None:
            shift = hand.shift if self.carried else self.led
            pose = here.pose._replace(translation=here.pose.translation + shift)
            there = rated(replace(here, pose=pose), view)
            taken = self.grasped and float(np.linalg.norm(shift)) > MIN_TAKEN
            empty = here.visibility.through > there.visibility.through + MORE
            if self.carried or taken or empty:
                sure = self.sure if self.carried and self.sure is not None else there.centre
                left = self.left if self.carried else here
                kept = replace(self, carried=True, fit=there, led=np.zeros(3), sure=sure, left=left)
                here = there
        if not _is_seen_through(here):
            return replace(kept, state="hidden", gone_for=0)
        gone_for = self.gone_for + 1
        limit = MAX_GONE_HELD if kept.carried else MAX_GONE
        return replace(kept, state="gone" if gone_for >= limit else "hidden", gone_for=gone_for)

    def _visible(self, fit: PoseFit, t: float, hand: MovingHand | None) -> DepthTrack:
        sure = self.sure
        if hand is None or not (self.carried or hand.speed <= MOVES):
            sure = None  # a hand that comes or goes holds nothing
        elif sure is None or fit.visibility.match >= WELL:
            sure = fit.centre
        return replace(self, fit=fit, t=t, state="visible", gone_for=0, sure=sure, left=None)

    def _best_fit(
        self, here: PoseFit, view: DepthView, t: float, hand: MovingHand | None
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

    def _starts(self, here: PoseFit, t: float, hand: MovingHand | None) -> list[PoseFit]:
        """Return where it was, resting and free, and where it would be by now."""
        free = replace(here, resting=here.resting._replace(weight=0.0))
        starts = [here] if _rests(here) and not self.carried else []
        shifts = [] if hand is None else [hand.shift]
        shifts.append(self.velocity * min(max(t - self.t, 0.0), MAX_LOOK_AHEAD))
        for shift in shifts:
            if np.linalg.norm(shift) > MIN_SHIFT:
                pose = here.pose._replace(translation=here.pose.translation + shift)
                starts.append(replace(free, pose=pose))
        starts.append(free)
        return starts if self.left is None else [*starts, self.left]

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


def _evidence(fit: PoseFit) -> float:
    """Return which share of its side speaks for a fit, less what speaks against it."""
    return fit.visibility.fit - fit.visibility.through


def _rests(fit: PoseFit) -> bool:
    """Whether a fit is about where it would be if it rested on the table."""
    upright = float(fit.pose.rotation[2] @ fit.resting.up)
    return abs(float(fit.centre[2]) - fit.resting.height) < LIFTED and upright > MIN_UPRIGHT
