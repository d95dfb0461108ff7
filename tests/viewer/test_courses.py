"""The time courses: every value where it belongs, and nothing where there is none."""

from __future__ import annotations

import numpy as np

from igrip import load_objects
from igrip.viewer.courses import GRIP, SPEED, TARGET, courses_of
from moments import demo_moments


def test_values_are_those_that_were_said():
    moments = demo_moments(load_objects("ycb"))
    courses = courses_of(moments, "left")
    assert courses.objects == tuple(placed.id for placed in moments[-1].objects)
    names = {SPEED, TARGET, GRIP, "global", "impacts", "distance", "distance_derivative",
             "future_distance"}  # fmt: skip
    assert set(courses.panels) == names
    seen = 0
    for k, moment in enumerate(moments):
        assert courses.times[k] == moment.t
        [hand] = [h for h in moment.hands if h.intention.hand == "left"]
        speed = np.nan if hand.motion is None else hand.motion.speed
        np.testing.assert_equal(courses.panels[SPEED][0, k], speed)
        for o, id in enumerate(courses.objects):
            row = hand.intention.scores.get(id, {})
            for name in names - {SPEED, TARGET, GRIP}:
                np.testing.assert_equal(courses.panels[name][o, k], row.get(name, np.nan))
                seen += name in row
            is_target = hand.intention.target == id
            np.testing.assert_equal(courses.panels[TARGET][o, k], o + 1 if is_target else np.nan)
        palmar, pinch = courses.panels[GRIP][:, k]
        np.testing.assert_equal(palmar, 1.0 if hand.intention.grip == "palmar" else np.nan)
        np.testing.assert_equal(pinch, 2.0 if hand.intention.grip == "pinch" else np.nan)
    assert seen > 300


def test_a_hand_that_is_not_there():
    moments = demo_moments(load_objects("ycb"))
    courses = courses_of(moments, "third")
    assert all(np.isnan(rows).all() for rows in courses.panels.values())


def test_nothing():
    assert courses_of([], "left").panels[SPEED].shape == (1, 0)
