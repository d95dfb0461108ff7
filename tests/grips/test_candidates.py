"""The selector of grasp candidates: reaches for declared grasps, and what must not change."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import igrip
from benchmarks.measure_grasps import declared_models, measure
from igrip.grips import GRIPS, GripConfig
from igrip.grips._choice import wrist_of
from igrip.intention import GRASP_FIELDS
from igrip.lab.simulation.grasp_reach import draw_grasp_reach
from igrip.targets import TargetEstimate
from reaching import at, intentions_of, reach_messages
from support import MeshCatalog

CAN = "cylinder:0.033x0.10"
PLACE = {"can": np.array([0.0, 0.4, 0.05])}
X, Y, Z = np.eye(3)


@pytest.mark.parametrize(
    ("approach", "closing", "expected"),
    [
        (Y, X, 0.0), (Y, -X, 0.0), (Y, Z, math.pi / 2), (-Z, X, 0.0), (-Z, Y, math.pi / 2),
        (Y, np.array([-1, 0, 1]) / math.sqrt(2), math.pi / 4),
        (X, Z, 0.0),  # from the side there is no direction across the reach: the height is
    ],
)  # fmt: skip
def test_the_wrist_of_a_hand_that_reaches_along_y(approach, closing, expected):
    told = wrist_of(approach, closing, Y)
    assert abs(abs(told) - abs(expected)) < 1e-12
    if expected != math.pi / 2:  # where both ends of the range are the same
        assert told == pytest.approx(expected, abs=1e-12)


def test_the_wrist_does_not_hang_on_the_frame():
    rng = np.random.default_rng(0)
    for _ in range(20):
        approach, closing = rng.normal(size=(2, 3))
        approach /= np.linalg.norm(approach)
        closing -= (closing @ approach) * approach
        closing /= np.linalg.norm(closing)
        yaw = rng.uniform(-3, 3)
        turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        told = wrist_of(approach, closing, Y)
        other = wrist_of(turn @ approach, turn @ closing, turn @ Y)
        assert told == pytest.approx(other, abs=1e-9)


@pytest.mark.parametrize(("height", "grip"), [(0.0, "palmar"), (0.11, "pinch")])
def test_from_the_side_and_from_above(shapes, height, grip):
    aside = 0.093 if grip == "palmar" else 0.0
    messages, onset, end = reach_messages(PLACE["can"] + [0.0, -aside, height], PLACE)
    told = at(intentions_of(messages, shapes, grips="candidates"), onset + 0.8 * (end - onset))
    assert told.grip == grip
    assert told.aperture == pytest.approx(0.066, abs=0.002)
    assert sum(told.grip_probability.values()) == pytest.approx(1.0)
    assert told.grip_probability[grip] > 0.5
    assert np.linalg.norm(np.array(told.contact) - PLACE["can"]) < 0.06
    if grip == "palmar":
        assert abs(told.wrist) < 0.2
        assert told.wrist_std < 0.5


def test_declared_reaches_are_told_by_four_fifths_of_the_movement():
    """Bars: grip 97 %, opening within 10 mm 90 %, wrist within 20° 85 %."""
    score = measure(declared_models(), 60, 11, False, "candidates")[0.8]
    assert score["grip"] >= 0.97 * score["reaches"]
    assert score["opening"] >= 0.90 * score["reaches"]
    assert score["wrist"] >= 0.85 * score["reaches"]


def test_a_measured_hand_tells_the_roll():
    models = {CAN: declared_models()[CAN]}
    rng = np.random.default_rng(4)
    reaches = [draw_grasp_reach(models, rng, turned=True) for _ in range(12)]
    tops = [r for r in reaches if r is not None and r.grasp.grip == "pinch"]
    assert tops
    for reach in tops:
        estimator = igrip.Estimator(MeshCatalog(models), igrip.Config(grips="candidates"))
        every = [i for m in reach.messages for i in estimator.update(m)]
        told = at(every, reach.end)
        off = (told.wrist - reach.wrist + math.pi / 2) % math.pi - math.pi / 2
        assert abs(off) < math.radians(25.0)
        assert told.wrist_std < 0.3


def test_the_order_of_objects_changes_nothing(shapes):
    two = {"a": np.array([-0.15, 0.4, 0.05]), "b": np.array([0.15, 0.4, 0.05])}
    goal = two["b"] + [0.0, -0.09, 0.0]
    told = []
    for objects in (two, dict(reversed(two.items()))):
        messages, _, end = reach_messages(goal, objects)
        told.append(at(intentions_of(messages, shapes, grips="candidates"), end))
    for name in ("grip", "grip_probability", *GRASP_FIELDS, "contact"):
        assert getattr(told[0], name) == pytest.approx(getattr(told[1], name))


@pytest.mark.parametrize("grips", ["cylinder", "contact"])
def test_messages_of_other_selectors_have_no_new_fields(shapes, grips):
    messages, *_ = reach_messages(PLACE["can"], PLACE)
    for told in intentions_of(messages, shapes, grips=grips):
        assert not set(GRASP_FIELDS) & set(told.to_dict())
        assert told.aperture is None


def test_without_probabilities_the_target_alone_counts(shapes):
    messages, _, end = reach_messages(PLACE["can"] + [0.0, -0.09, 0.0], PLACE)
    told = at(intentions_of(messages, shapes, "paper", grips="candidates"), end)
    assert told.grip == "palmar"
    assert sum(told.grip_probability.values()) == pytest.approx(1.0)


def test_no_target_and_nothing_to_hold_no_grip():
    grip = GRIPS.get("candidates")(GripConfig())
    assert grip.select(TargetEstimate(None, np.zeros(0)), None, None).name is None
    models = igrip.load_objects("box:0.3x0.3x0.3")
    name = next(iter(models))
    large = replace(models[name])
    messages, _, end = reach_messages(PLACE["can"], PLACE, model=name)
    told = at(intentions_of(messages, MeshCatalog({name: large}), grips="candidates"), end)
    assert told.grip is None
    assert told.aperture is None
