"""The grip by where the hand will touch: numbers by hand, and reaches from the side and above."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.geometry.cylinder import Cylinders
from igrip.grips import GRIPS, GripConfig
from igrip.grips.contact import INPUTS, TERMS, approaches, pinch_odds, weights
from igrip.targets import TargetEstimate
from reaching import at, intentions_of, reach_messages

CAN = "cylinder:0.033x0.10"
PLACE = {"can": np.array([0.0, 0.4, 0.05])}


def approached(position, velocity):
    """Return the inputs for an upright cylinder at the origin, half-length 0.1, radius 0.03."""
    upright = Cylinders.of(
        np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]), np.array([0.1]), np.array([0.03]),
        np.zeros((1, 3)),
    )  # fmt: skip
    inputs = approaches(np.array(position), np.array(velocity), upright)
    return dict(zip(INPUTS, inputs[0], strict=True))


def test_a_hand_that_rises_on_its_way():
    told = approached([0.13, 0.0, -0.05], [-0.5, 0.0, 0.5])
    assert told["height_now"] == pytest.approx(-0.5)
    assert told["height_at_contact"] == pytest.approx(-0.5 + 5.0 * 0.2)  # 0.1 m aside at 0.5 m/s
    assert told["height_soon"] == pytest.approx(0.5)  # contact comes before 0.3 s
    assert told["aside"] == pytest.approx(1.0)
    assert told["descent"] == pytest.approx(-np.sqrt(0.5))


def test_upside_down_is_the_same():
    a = approached([0.1, 0.05, 0.08], [-0.2, 0.0, 0.1])
    b = approached([0.1, 0.05, -0.08], [-0.2, 0.0, -0.1])
    assert a == pytest.approx(b)


def test_log_odds_are_the_polynomial_of_the_terms():
    rng = np.random.default_rng(0)
    inputs, values = rng.normal(size=(5, len(INPUTS))), rng.normal(size=len(TERMS))
    odds = pinch_odds(inputs, values)
    named = dict(zip(TERMS, values, strict=True))
    for row, found in zip(inputs, odds, strict=True):
        known = dict(zip(INPUTS, row, strict=True)) | {"1": 1.0}
        expected = sum(
            value * np.prod([known[part] for part in term.split()]) for term, value in named.items()
        )
        assert found == pytest.approx(expected)
    assert len(weights()) == len(TERMS)


@pytest.mark.parametrize(("height", "grip"), [(0.0, "palmar"), (0.10, "pinch")])
def test_from_the_side_palmar_and_from_above_pinch(shapes, height, grip):
    aside = 0.08 if grip == "palmar" else 0.0
    goal = PLACE["can"] + [0.0, -aside, height]
    messages, onset, end = reach_messages(goal, PLACE)
    answers = intentions_of(messages, shapes)
    for part in (0.8, 1.0):
        told = at(answers, onset + part * (end - onset))
        assert told.grip == grip
        assert told.grip_probability[grip] > 0.5
        assert sum(told.grip_probability.values()) == pytest.approx(1.0)


def test_without_a_posterior_it_is_the_papers_rule(shapes):
    messages, *_ = reach_messages(PLACE["can"], PLACE)
    mine = intentions_of(messages, shapes, "paper", grips="contact")
    papers = intentions_of(messages, shapes, "paper", grips="cylinder")
    assert [i.to_dict() for i in mine] == [i.to_dict() for i in papers]
    assert any(i.grip for i in mine)


def test_no_target_no_grip():
    grip = GRIPS.get("contact")(GripConfig())
    assert grip.select(TargetEstimate(None, np.zeros(0), np.ones(1)), None, None).name is None
