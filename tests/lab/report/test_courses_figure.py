"""Figure 6: the time courses of the task's hand, with an arrow at each k_target."""

from types import SimpleNamespace

import numpy as np

from igrip.intention import Intention
from igrip.lab.report.courses_figure import courses_of_trial, draw_courses, find_k_target
from trial_messages import TRIAL

BOUNDS = (0.2, 1.0)


def run(cup=(0.1, 0.2, 0.6, 0.7), hand="right", probability=None):
    """Return a run whose scores of the cup are given, beside 0.5 of a can."""
    intentions = []
    for k, score in enumerate(cup):
        scores = {"cup": {"global": score, "distance": 1.0}, "can": {"global": 0.5}}
        intentions += [
            Intention(t=0.3 + k / 10, hand=name, status="reaching", scores=scores, target="cup",
                      grip="pinch", probability=probability)
            for name in (hand, "other")
        ]  # fmt: skip
    speeds = [0.1 * k for k in range(len(intentions))]
    estimator = SimpleNamespace(intentions=intentions, speeds=speeds)
    return SimpleNamespace(trial=TRIAL, estimators=[estimator])


def test_only_the_hand_of_the_task():
    courses = courses_of_trial(run())
    np.testing.assert_allclose(courses.times, [0.3, 0.4, 0.5, 0.6])
    np.testing.assert_allclose(courses.panels["speed [m/s]"], [[0.0, 0.2, 0.4, 0.6]])
    assert courses.objects == ("can", "cup")


def test_k_target_by_hand():
    courses = courses_of_trial(run())
    assert find_k_target(courses, "global", "cup", BOUNDS) == 0.5
    assert find_k_target(courses, "global", "can", BOUNDS) == 0.3
    assert find_k_target(courses, "distance", "cup", BOUNDS) is None  # the can's is not known
    assert find_k_target(courses, "global", "mug", BOUNDS) is None


def test_panels():
    figure = draw_courses(run(probability={"cup": 0.7, "can": 0.1, "none": 0.2}), BOUNDS)
    panels = figure.axes
    assert [panel.get_title(loc="left") for panel in panels] == list("ABCDEFGH")
    global_lines = {line.get_label(): line.get_ydata() for line in panels[5].lines}
    np.testing.assert_allclose(global_lines["cup"], [0.1, 0.2, 0.6, 0.7])
    [none] = [line for line in panels[5].lines if line.get_linestyle() == "--"]
    np.testing.assert_allclose(none.get_ydata(), 0.2)
    np.testing.assert_allclose(panels[0].lines[0].get_xdata(), [0.1, 0.2, 0.3, 0.4])
    arrows = [panel.texts[0].xy[0] for panel in panels if panel.texts]
    np.testing.assert_allclose(arrows, [0.3])  # of the global score, from the onset on
    for panel in panels[6:]:  # the second object, the second grip
        first, second = (line.get_ydata() for line in panel.lines[:2])
        np.testing.assert_equal(first, [np.nan] * 4)
        np.testing.assert_equal(second, [2.0] * 4)
    figure.draw_without_rendering()


def test_a_hand_that_was_never_measured_has_no_figure():
    assert draw_courses(run(hand="third"), BOUNDS) is None
