"""Time courses: every value where it belongs, and nothing where there is none."""

import numpy as np

from igrip.intention import Intention
from igrip.lab.evaluation.time_courses import GRIP, SPEED, TARGET, time_courses

NAN = np.nan


def answer(t, target=None, grip=None, probability=None, **scores):
    return Intention(
        t=t, hand="right", status="reaching", target=target, grip=grip, probability=probability,
        scores={id: dict(zip(("distance", "global"), row)) for id, row in scores.items()},  # noqa: B905
    )  # fmt: skip


def test_by_hand():
    intentions = [
        answer(0.0),
        answer(0.1, "cup", "pinch", cup=(0.5, 0.7), can=(0.4, 0.3)),
        answer(0.2, "can", "palmar", {"can": 0.6, "box": 0.1, "none": 0.3}, can=(0.4, 0.6),
               box=(0.1,)),
    ]  # fmt: skip
    courses = time_courses(intentions, [NAN, 0.3, 0.4])
    np.testing.assert_equal(courses.times, [0.0, 0.1, 0.2])
    assert courses.objects == ("box", "can", "cup")
    assert list(courses.panels) == [SPEED, "distance", "global", TARGET, GRIP]
    np.testing.assert_equal(courses.panels[SPEED], [[NAN, 0.3, 0.4]])
    np.testing.assert_equal(
        courses.panels["distance"], [[NAN, NAN, 0.1], [NAN, 0.4, 0.4], [NAN, 0.5, NAN]]
    )
    np.testing.assert_equal(
        courses.panels["global"], [[NAN, NAN, NAN], [NAN, 0.3, 0.6], [NAN, 0.7, NAN]]
    )
    np.testing.assert_equal(
        courses.panels[TARGET], [[NAN, NAN, NAN], [NAN, NAN, 2.0], [NAN, 3.0, NAN]]
    )
    np.testing.assert_equal(courses.panels[GRIP], [[NAN, NAN, 1.0], [NAN, 2.0, NAN]])
    np.testing.assert_equal(courses.none, [NAN, NAN, 0.3])


def test_past_targets_first_and_then_the_likeliest():
    first = answer(0.0, "e", **dict.fromkeys("abcdef", (0.1, 0.2)))
    last = answer(0.1, "b", a=(0.1, 0.9), b=(0.1, 0.5), c=(0.9, 0.2), d=(0.1, 0.3), f=(0.1,))

    def objects(most):
        return "".join(time_courses([first, last], [0.1, 0.1], most).objects)

    assert objects(None) == objects(6) == "abcdef"
    assert objects(1) == "b"  # the newest target
    assert objects(2) == "be"
    assert objects(3) == "abe"
    assert objects(4) == "abde"
    assert objects(5) == "abcde"
    both = [answer(0.0, **dict.fromkeys("dcba", (0.1, 0.5)))]
    assert time_courses(both, [0.1], 2).objects == ("a", "b")  # equally likely: by id
    panels = time_courses([first, last], [0.1, 0.1], 2).panels
    assert panels["global"].shape == panels[TARGET].shape == (2, 2)


def test_without_answers_or_objects():
    courses = time_courses([], [])
    assert courses.times.shape == courses.none.shape == (0,)
    assert courses.objects == ()
    assert {name: rows.shape for name, rows in courses.panels.items()} == {
        SPEED: (1, 0), TARGET: (0, 0), GRIP: (2, 0),
    }  # fmt: skip
    assert time_courses([answer(0.0)], [NAN], 0).panels[TARGET].shape == (0, 1)
