"""Targets of two hands: joint beside a wide object, and else untouched to the last bit."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import igrip
from igrip.joint_targets import ALONE, BOTH, JointTargets, is_wide, joint_marginal
from igrip.lab.simulation.minimum_jerk import progress
from support import BOX, CAN, UPRIGHT

WIDE = "box:0.30x0.20x0.18"
beliefs = st.lists(st.floats(0.0, 1.0), min_size=3, max_size=6).filter(lambda p: sum(p) > 0.1)


@given(beliefs, beliefs, st.integers(0, 1))
def test_the_marginal_is_that_of_the_joint_posterior_over_pairs_of_targets(a, b, o):
    """By brute force over every pair of targets."""
    size = min(len(a), len(b))
    own, theirs = np.array(a[:size]), np.array(b[:size])
    if not own.sum() or not theirs.sum():
        return
    own, theirs = own / own.sum(), theirs / theirs.sum()
    expected = np.zeros(size)
    for i, j in itertools.product(range(size), repeat=2):
        factor = BOTH if i == j == o else ALONE if o in (i, j) else 1.0
        expected[i] += own[i] * theirs[j] * factor
    np.testing.assert_allclose(
        joint_marginal(own, float(theirs[o]), o), expected / expected.sum(), atol=1e-12
    )


@pytest.mark.parametrize(
    ("name", "wide"), [(WIDE, True), (BOX, False), (CAN, False), ("box:0.5x0.5x0.11", False)]
)
def test_wide_is_what_exceeds_a_hand_in_every_direction(name, wide):
    assert is_wide(igrip.load_objects(name)[name]) == wide


def messages(goals, objects, starts, others_begin=0.3):
    """Return messages of hands that reach for goals, and of objects that stand."""
    for k in range(50):
        t = k / 30.0
        hands = {}
        for n, (hand, goal) in enumerate(goals.items()):
            done = progress(np.array([t - 0.3 - n * (others_begin - 0.3)]))[0]
            place = starts[hand] + (np.array(goal) - starts[hand]) * done
            hands[hand] = {"position": (place + 1e-4 * (k % 3)).tolist()}
        yield igrip.Observation(t=t, hands=hands, objects={} if k else objects)


STARTS = {"left": np.array([-0.2, 0.0, 0.05]), "right": np.array([0.2, 0.0, 0.05])}


def run(goals, objects):
    catalog = igrip.load_objects(*{pose["model"] for pose in objects.values()})
    estimator = igrip.Estimator(catalog)
    return [i for m in messages(goals, objects, STARTS) for i in estimator.update(m)]


def thing(model, *position):
    return {"model": model, "position": list(position), "orientation": UPRIGHT, "static": True}


APART = {"a": thing(CAN, -0.25, 0.4, 0.05), "b": thing(CAN, 0.25, 0.4, 0.05)}
BESIDE = {
    "wide": thing(WIDE, 0.0, 0.4, 0.09), "a": thing(CAN, -0.28, 0.55, 0.05),
    "b": thing(CAN, 0.28, 0.55, 0.05),
}  # fmt: skip


def of(intentions, hand):
    return [i.to_dict() for i in intentions if i.hand == hand]


def test_without_a_wide_object_each_hand_is_as_if_it_were_alone():
    goals = {"left": [-0.2, 0.38, 0.05], "right": [0.2, 0.38, 0.05]}
    both = run(goals, APART)
    for hand, goal in goals.items():
        assert of(both, hand) == of(run({hand: goal}, APART), hand)


def test_beside_a_wide_object_that_no_hand_takes_each_is_as_if_it_were_alone():
    far = {"wide": thing(WIDE, 0.0, -2.0, 0.09), **APART}
    goals = {"left": [-0.2, 0.38, 0.05], "right": [0.2, 0.38, 0.05]}
    both = run(goals, far)
    for hand, goal in goals.items():
        assert of(both, hand) == of(run({hand: goal}, far), hand)


def test_a_hand_that_rests_changes_nothing_for_the_other():
    goals = {"left": STARTS["left"].tolist(), "right": [0.18, 0.4, 0.09]}
    both = run(goals, BESIDE)
    assert of(both, "right") == of(run({"right": goals["right"]}, BESIDE), "right")


def test_hands_at_both_sides_of_a_wide_object_take_it():
    """Each alone is taken to be on its way to what stands behind."""
    goals = {"left": [-0.19, 0.4, 0.09], "right": [0.19, 0.4, 0.09]}
    both = run(goals, BESIDE)
    alone = run({"left": goals["left"]}, BESIDE)
    late = [i for i in both if 0.8 < i.t < 1.2]
    assert all(i.target == "wide" for i in late)
    assert np.mean([i.probability["wide"] for i in late]) > 0.1 + np.mean(
        [i.probability["wide"] for i in alone if 0.8 < i.t < 1.2]
    )
    for intention in both:
        assert intention.probability is None or sum(
            intention.probability.values()
        ) == pytest.approx(1.0)


def test_estimators_without_probabilities_are_left_alone():
    goals = {"left": [-0.19, 0.4, 0.09], "right": [0.19, 0.4, 0.09]}
    catalog = igrip.load_objects(WIDE, CAN)
    estimator = igrip.Estimator(catalog, igrip.Config(targets="paper"))
    alone = igrip.Estimator(catalog, igrip.Config(targets="paper"))
    for both in messages(goals, BESIDE, STARTS):
        pair = estimator.update(both)
        [single] = alone.update(
            igrip.Observation(t=both.t, hands={"left": both.hands["left"]}, objects=both.objects)
        )
        assert pair[0] == single


def test_no_hands_no_objects():
    assert JointTargets(lambda: None).update([], [], []) == []
