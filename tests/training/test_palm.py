"""Training of the palm: mirror images, a known dependence, and arms that are what they say."""

import numpy as np
import pytest

from igrip.perception.arms.end_shape import INPUTS
from training.palm import fit_palm, left_out, mirrored
from training.worn_hands import EDGE, KINDS, NEAR, arm_views


def some(count=400, seed=0):
    random = np.random.default_rng(seed)
    inputs = 0.02 * random.standard_normal((count, INPUTS))
    palms = np.stack([0.1 + inputs[:, 0], 0.5 * (inputs[:, 25] + inputs[:, 45]),
                      -0.02 + inputs[:, 65]], axis=1)  # fmt: skip
    return inputs, palms


def test_a_mirror_image_of_a_mirror_image():
    inputs, palms = some()
    once, there = mirrored(inputs, palms)
    again, back = mirrored(once, there)
    assert again == pytest.approx(inputs)
    assert back == pytest.approx(palms)
    assert not np.allclose(once, inputs)
    assert there[:, 1] == pytest.approx(-palms[:, 1])


def test_a_known_dependence_is_learned():
    inputs, palms = some(1500)
    model = fit_palm(inputs, palms, 0)
    others, there = some(200, seed=1)
    spread = np.linalg.norm(there - there.mean(axis=0), axis=1).mean()
    assert np.linalg.norm(model.palm(others) - there, axis=1).mean() < 0.35 * spread


def test_each_kind_is_left_out_once():
    inputs, palms = some(60)
    off = left_out(inputs, palms, ["a"] * 30 + ["b"] * 30)
    assert {name: len(one) for name, one in off.items()} == {"a": 30, "b": 30}


def test_arms_are_where_their_points_are():
    arms = [arm for number in range(len(KINDS)) for arm in arm_views(number, 3)]
    assert {arm.kind for arm in arms} == set(KINDS)
    for arm in arms:
        assert len(arm.points) >= 200
        assert arm.points[:, 1].min() > EDGE
        # something of the hand is measured near the palm, and the arm comes in behind it
        assert np.linalg.norm(arm.points - arm.palm, axis=1).min() < NEAR
        assert arm.entry[1] < arm.palm[1]
    again = arm_views(0, 3)
    assert [arm.points.tolist() for arm in again] == [a.points.tolist() for a in arms[: len(again)]]
