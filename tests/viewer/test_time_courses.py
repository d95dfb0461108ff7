"""The time courses: every value where it belongs, and nothing where there is none."""

from __future__ import annotations

from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np

from igrip import Estimator, Observation, load_objects
from igrip.lab.speed import scenes
from igrip.viewer.snapshot import take_snapshot
from igrip.viewer.time_courses import GRIP, SPEED, TARGET, CoursesPanels, courses_of
from moments import demo_moments


def test_values_are_those_that_were_said():
    moments = demo_moments(load_objects("ycb"))
    courses = courses_of(moments, "left")
    assert courses.objects == tuple(sorted(placed.id for placed in moments[-1].objects))
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


def test_hands_that_are_measured_in_turn_have_whole_lines(ycb):
    estimator, moments = Estimator(ycb), []
    pose = {"model": "006_mustard_bottle", "position": [0, 0.4, 0], "orientation": [0, 0, 0, 1]}
    for k in range(80):
        hand = {("left", "right")[k % 2]: {"position": [0.1, 0.004 * k, 0.1]}}
        estimator.update(Observation(t=k / 60, hands=hand, objects={"mustard": pose}))
        moments.append(take_snapshot(estimator))
    assert [h.intention.hand for h in moments[-1].hands] == ["left", "right"]
    courses = courses_of(moments, "left")
    assert len(courses.times) == 40
    assert np.isfinite(courses.panels[SPEED][0]).sum() > 30


def test_among_many_objects_the_targets_have_lines(ycb):
    estimator, moments = Estimator(ycb), []
    for frame in scenes.frames(60, objects=30):
        estimator.update(frame)
        moments.append(take_snapshot(estimator))
    courses = courses_of(moments, "hand0")
    targets = {h.intention.target for m in moments for h in m.hands if h.intention.hand == "hand0"}
    assert len(courses.objects) == 8
    assert {moments[-1].hands[0].intention.target} <= set(courses.objects)
    assert len(targets & set(courses.objects)) >= min(8, len(targets - {None}))


class FakePlot:
    def __init__(self, lines):
        self.lines, self.data, self.visible = lines, None, True

    def remove(self):
        self.data = "removed"


class FakeGui:
    """Stands for viser's: it refuses what viser refuses."""

    def __init__(self):
        self.plots = []

    def add_folder(self, name):
        return nullcontext()

    def add_html(self, text):
        return SimpleNamespace(content=text)

    def add_uplot(self, data, series, **more):
        assert len(data) >= 2
        assert len(data) == len(series)
        self.plots.append(FakePlot(len(data)))
        return self.plots[-1]


def test_panels_come_and_go_with_what_there_is_to_show():
    """Before the first answer there are no scores, and without objects no targets."""
    moments = demo_moments(load_objects("ycb"))
    gui = FakeGui()
    panels = CoursesPanels(SimpleNamespace(gui=gui))
    for part, count in ((moments, 8), (moments[:1], 2), (moments[:2], 2), ([], 2), (moments, 8)):
        panels.show(courses_of(part, "left"), {})
        shown = [plot for plot in gui.plots if plot.data != "removed"]
        assert len(shown) == count
        assert all(len(plot.data[0]) == len(part) for plot in shown)


def test_a_hand_that_is_not_there():
    moments = demo_moments(load_objects("ycb"))
    courses = courses_of(moments, "third")
    assert all(np.isnan(rows).all() for rows in courses.panels.values())


def test_nothing():
    assert courses_of([], "left").panels[SPEED].shape == (1, 0)
