"""Which hand holds what: things that move along with a hand, until the hand is away."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.geometry.scene import RayConfig, Scene
from igrip.holding import Holding
from igrip.lab.simulation.minimum_jerk import progress
from igrip.motion.trajectory import MotionConfig, Trajectory
from igrip.targets import HandEstimate, TargetEstimate
from support import CAN, placed

RATE, POSE_EVERY = 30.0, 3  # Hz, and frames between two poses of an object
NEAR = np.array([0.0, -0.08, 0.0])  # of a palm beside the can [m]


class Stage:
    """Palms and a can that move as functions of time say."""

    def __init__(self, model, **palms):
        self.model, self.palms = model, palms
        self.tracks = {hand: Trajectory(MotionConfig()) for hand in palms}
        self.scene, self.holding = Scene(RayConfig()), Holding(0.12, 0.06)
        self.path = []

    def run(self, can, begin, end, unseen=(), late=0.0):
        """Return, for each frame, what each hand must not take."""
        frames = []
        for k in range(round(begin * RATE), round(end * RATE)):
            t = k / RATE
            if k % POSE_EVERY == 0:
                self.path.append((t, *can(max(0.0, t - late))))
            recent = np.array([row for row in self.path if t - row[0] <= 2.5])
            moves = np.ptp(recent[:, 1:], axis=0).max() > 0.03
            thing = placed(self.model, "can", translation=self.path[-1][1:])
            thing = thing._replace(path=recent if moves else None)
            hands = []
            for hand, palm in self.palms.items():
                motion = self.tracks[hand].update(t, tuple(palm(t).tolist()))
                if hand in unseen or motion is None:
                    continue
                [geometry] = self.scene.measure([motion], [thing])
                estimate = TargetEstimate(None, np.zeros(1))
                hands.append(HandEstimate(hand, motion, geometry, estimate))
            self.holding.update(hands, self.palms.keys(), [hand.id for hand in hands])
            frames.append({hand: dict(self.holding.by_others(hand)) for hand in self.palms})
        return frames


def brings(t):
    """Return the way of what is brought: 40 cm within the first second."""
    return np.array([0.4, 0.0, 0.0]) * progress(np.array([t]))[0]


def rests(place):
    return lambda t: np.array(place, dtype=float)


@pytest.fixture
def can(shapes):
    return shapes[CAN]


@pytest.mark.parametrize("late", [0.0, 0.1])
def test_what_a_hand_carries_is_held_for_every_other_hand_and_not_for_itself(can, late):
    stage = Stage(can, left=lambda t: brings(t) + NEAR, right=rests([0.4, 0.4, 0.0]))
    frames = stage.run(brings, 0.0, 2.0, late=late)
    held = [frame["right"] == {"can": "left"} for frame in frames]
    assert not held[0]
    assert all(held[round(0.75 * RATE) :])  # also at rest, after it was brought
    assert all(frame["left"] == {} for frame in frames)


def test_it_is_free_once_the_hand_is_away(can):
    def leaves(t):
        return brings(t) + NEAR - [0.0, 0.4 * progress(np.array([t - 2.0]))[0], 0.0]

    stage = Stage(can, left=leaves, right=rests([0.4, 0.4, 0.0]))
    frames = stage.run(brings, 0.0, 3.5)
    assert frames[round(1.9 * RATE)]["right"] == {"can": "left"}
    assert frames[-1]["right"] == {}


def test_a_hand_that_passes_by_or_meets_it_does_not_hold_it(can):
    def meets(t):
        return np.array([0.8, 0.0, 0.0]) - brings(t) - NEAR

    stage = Stage(can, left=meets, right=rests([0.4, 0.4, 0.0]))
    assert all(frame["right"] == {} for frame in stage.run(brings, 0.0, 2.0))


def test_a_hand_that_rests_at_a_standing_object_does_not_hold_it(can):
    stage = Stage(can, left=rests(NEAR), right=rests([0.4, 0.4, 0.0]))
    assert all(frame["right"] == {} for frame in stage.run(rests([0, 0, 0]), 0.0, 2.0))


def test_hands_that_lift_together_refuse_each_other_nothing(can):
    stage = Stage(can, left=lambda t: brings(t) + NEAR, right=lambda t: brings(t) - NEAR)
    frames = stage.run(brings, 0.0, 2.0)
    assert frames[-1] == {"left": {}, "right": {}}


def test_who_took_it_later_gets_nothing_before_the_first_lets_go(can):
    """The receiver carries it along, and the giver's hand stays at it."""

    def both(t):
        return brings(t) + [0.0, 0.0, 0.3 * progress(np.array([t - 1.5]))[0]]

    def joins(t):
        return both(t) - NEAR + np.array([0.0, 0.4, 0.0]) * (1 - progress(np.array([t - 0.4]))[0])

    stage = Stage(can, left=lambda t: both(t) + NEAR, right=joins)
    assert stage.run(both, 0.0, 3.0)[-1] == {"left": {}, "right": {"can": "left"}}


def test_a_holder_that_is_hidden_keeps_it_until_it_has_stood_still(can):
    stage = Stage(can, left=lambda t: brings(t) + NEAR, right=rests([0.4, 0.4, 0.0]))
    stage.run(brings, 0.0, 1.5)
    frames = stage.run(brings, 1.5, 5.0, unseen=("left",))
    assert frames[round(1.0 * RATE)]["right"] == {"can": "left"}
    assert frames[-1]["right"] == {}


def test_one_hand_alone_is_not_followed(can):
    stage = Stage(can, left=lambda t: brings(t) + NEAR)
    stage.run(brings, 0.0, 1.5)
    assert stage.holding.by_others("right") == {}
