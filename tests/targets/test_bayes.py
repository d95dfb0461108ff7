"""The posterior: what it is at rest, on the way, at the end, and when objects come and go."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import igrip
from igrip.targets.bayes import MIN_NONE_AT_REST, pool, resting_posterior
from reaching import SPREAD, START, TWO, at, intentions_of, reach_messages
from support import CAN, UPRIGHT

SHORT = np.array([0.0, 0.06, 0.0])  # a palm stops beside an object, not in its middle


def likeliest(intention):
    return max(intention.probability, key=intention.probability.get)


@pytest.mark.parametrize("goal", ["near", "far"])
@pytest.mark.parametrize("rate", [15.0, 30.0, 60.0, 120.0])
def test_a_reach_is_told_before_its_end_at_any_rate(shapes, goal, rate):
    messages, onset, end = reach_messages(TWO[goal] - SHORT, TWO, rate, noise=0.001)
    answers = intentions_of(messages, shapes)
    assert likeliest(at(answers, onset - 0.05)) == "none"
    assert at(answers, onset - 0.05).target is None
    for part in (0.8, 0.9, 1.0):
        assert at(answers, onset + part * (end - onset)).target == goal
    assert at(answers, end).probability[goal] > 0.8
    assert answers[-1].target == goal  # it stays there


@pytest.mark.parametrize("goal", ["left", "right"])
def test_objects_apart_are_told_early(shapes, goal):
    messages, onset, end = reach_messages(SPREAD[goal], SPREAD, noise=0.002)
    assert at(intentions_of(messages, shapes), onset + 0.45 * (end - onset)).target == goal


def test_probabilities_are_some_and_sum_to_one(shapes):
    messages, *_ = reach_messages(TWO["far"], TWO, noise=0.004)
    for answer in intentions_of(messages, shapes):
        if answer.probability is not None:
            assert set(answer.probability) == {"near", "far", "none"}
            assert sum(answer.probability.values()) == pytest.approx(1.0)
            assert all(0.0 <= p <= 1.0 for p in answer.probability.values())
            assert (
                answer.confidence is None or answer.confidence == answer.probability[answer.target]
            )


def test_a_hand_that_goes_home_again_wants_nothing(shapes):
    there, _, end = reach_messages(SPREAD["left"], SPREAD, hold=0.3)
    home = np.array(there[-1]["hands"]["right"]["position"])
    back, *_ = reach_messages(START, SPREAD, rest=0.0, hold=1.5, start=home)
    for message in back:
        message["t"] += there[-1]["t"] + 1.0 / 30.0
        message["objects"] = {}
    answers = intentions_of(there + back, shapes)
    assert at(answers, end + 0.2).target == "left"
    assert answers[-1].target is None
    assert likeliest(answers[-1]) == "none"


def test_a_change_of_mind_is_followed(shapes):
    messages, onset, _ = reach_messages(SPREAD["left"], SPREAD, lasts=1.0, hold=0.0)
    half = [m for m in messages if m["t"] <= onset + 0.55]
    turn = np.array(half[-1]["hands"]["right"]["position"])
    rest, *_ = reach_messages(SPREAD["right"], SPREAD, rest=0.0, lasts=0.8, start=turn)
    for message in rest:
        message["t"] += half[-1]["t"] + 1.0 / 30.0
        message["objects"] = {}
    answers = intentions_of(half + rest, shapes)
    assert at(answers, onset + 0.55).target == "left"
    assert answers[-1].target == "right"


@pytest.mark.parametrize("count", [0, 1, 3, 30, 100])
def test_any_number_of_objects(shapes, count):
    rng = np.random.default_rng(count)
    goal = np.array([0.1, 0.4, 0.05])
    objects = {"goal": goal} if count else {}
    while len(objects) < count:  # clutter at the sides and behind
        place = rng.uniform([-1.0, -0.8, 0.0], [1.0, 0.9, 0.3])
        if np.linalg.norm(place - goal) > 0.25 and not (abs(place[0]) < 0.3 and 0 < place[1] < 0.6):
            objects[f"o{len(objects)}"] = place
    messages, _, end = reach_messages(goal - SHORT, objects, noise=0.002)
    answers = intentions_of(messages, shapes)
    last = at(answers, end)
    assert len(last.probability) == count + 1
    assert last.target == ("goal" if count else None)
    if not count:
        assert last.probability == {"none": 1.0}


def test_objects_may_appear_and_vanish_on_the_way(shapes):
    messages, onset, end = reach_messages(SPREAD["right"], {"left": SPREAD["left"]}, hold=0.4)
    for message in messages:
        if message["t"] > onset + 0.5:
            message["objects"] = {
                "right": {
                    "model": CAN,
                    "position": SPREAD["right"].tolist(),
                    "orientation": UPRIGHT,
                }
            }
    answers = intentions_of(messages, shapes)
    assert set(at(answers, onset + 0.4).probability) == {"left", "none"}
    assert at(answers, end).target == "right"
    gone = [json.loads(json.dumps(m)) for m in messages if m["t"] <= end]
    for k in range(1, 90):  # the right one is no longer seen, for longer than its pose is usable
        gone.append({"t": end + k / 30.0, "hands": gone[-1]["hands"], "objects": {}})
    last = intentions_of(gone, shapes)[-1]
    assert set(last.probability) == {"left", "none"}
    assert likeliest(last) == "none"


def test_turning_the_world_or_renaming_changes_nothing(shapes):
    messages, *_ = reach_messages(TWO["far"], TWO | SPREAD, noise=0.003)
    turn, shift = Rotation.random(random_state=4), np.array([3.0, -2.0, 1.0])
    names = {"near": "z", "far": "b", "left": "c", "right": "a"}
    other = json.loads(json.dumps(messages, default=lambda x: x.tolist()))
    for message in other:
        hand = message["hands"]["right"]
        hand["position"] = (turn.apply(hand["position"]) + shift).tolist()
        message["objects"] = {names[id]: pose for id, pose in message["objects"].items()}
        for pose in message["objects"].values():
            pose["position"] = (turn.apply(pose["position"]) + shift).tolist()
            pose["orientation"] = (
                (turn * Rotation.from_quat(pose["orientation"])).as_quat().tolist()
            )
    for a, b in zip(intentions_of(messages, shapes), intentions_of(other, shapes), strict=True):
        if a.probability is None:
            assert b.probability is None
            continue
        assert (names | {None: None})[a.target] == b.target
        for id, p in a.probability.items():
            assert b.probability[(names | {"none": "none"})[id]] == pytest.approx(p, abs=1e-6)


def test_pooling_is_the_stated_formula():
    posterior, scores, keep, change = np.array([0.2, 0.3, 0.5]), np.array([1.0, -2.0]), 0.7, 0.01
    logs = keep * np.log((1 - change) * posterior + change / 3) + (1 - keep) * np.array(
        [1.0, -2.0, 0]
    )
    pool(posterior, scores, keep, change)
    assert posterior == pytest.approx(np.exp(logs) / np.exp(logs).sum())


def test_no_score_makes_it_other_than_a_probability():
    posterior = resting_posterior(3)
    for scores in ([800.0, -800.0, 0.0], [-800.0, -800.0, -800.0], [800.0, 800.0, 800.0]):
        pool(posterior, np.array(scores), 0.1, 1e-3)
        assert np.isfinite(posterior).all()
        assert posterior.sum() == pytest.approx(1.0, abs=1e-5)


def test_at_rest_none_is_likelier_than_any_object():
    for objects in (1, 2, 100):
        posterior = resting_posterior(objects)
        assert posterior.sum() == pytest.approx(1.0)
        assert posterior[-1] >= MIN_NONE_AT_REST
        assert posterior[-1] >= 1.9 * posterior[:-1].max()
    assert resting_posterior(0).tolist() == [1.0]


def test_two_hands_have_a_posterior_each(shapes):
    messages, _, end = reach_messages(SPREAD["right"], SPREAD)
    for message in messages:
        message["hands"]["left"] = {"position": [-0.3, 0.0, 0.05]}
    estimator = igrip.Estimator(shapes, igrip.Config(targets="bayes"))
    last = {}
    for message in messages:
        last |= {
            i.hand: i for i in estimator.update(igrip.Observation(**message)) if message["t"] <= end
        }
    assert last["right"].target == "right"
    assert last["left"].target is None


@pytest.mark.parametrize("rate", [15.0, 30.0, 120.0])
@pytest.mark.parametrize("noise", [0.001, 0.004, 0.008])
def test_a_hand_that_rests_in_noise_is_given_nothing(shapes, rate, noise):
    messages, *_ = reach_messages(
        SPREAD["left"], SPREAD, rate, rest=20.0, lasts=0.5, hold=0.0, noise=noise, seed=2
    )
    at_rest = [i for i in intentions_of(messages, shapes) if 1.0 < i.t < 19.9]
    assert np.mean([likeliest(i) == "none" for i in at_rest]) > 0.99
    assert not any(i.commitment for i in at_rest)


@pytest.mark.parametrize("rate", [15.0, 60.0])
def test_a_slow_hand_is_told_what_it_reaches_for(shapes, rate):
    messages, onset, end = reach_messages(
        SPREAD["right"], SPREAD, rate, rest=1.0, lasts=6.0, noise=0.001
    )
    answers = intentions_of(messages, shapes)
    assert at(answers, onset + 0.9 * (end - onset)).target == "right"


@pytest.mark.parametrize("rate", [15.0, 30.0, 60.0, 120.0])
@pytest.mark.parametrize("noise", [0.001, 0.002, 0.004])
def test_a_hand_that_has_stopped_keeps_its_target_for_a_while(shapes, rate, noise):
    for seed in range(3):
        messages, _, end = reach_messages(
            SPREAD["left"] - SHORT, SPREAD, rate, rest=1.0, hold=0.7, noise=noise, seed=seed
        )
        answers = intentions_of(messages, shapes)
        assert all(i.target == "left" for i in answers if i.t > end)


def test_a_hand_that_starts_in_the_middle_of_an_object_poisons_nothing(shapes):
    """Noiseless, exactly on the axis, and away at once: there is no way to go at all."""
    estimator = igrip.Estimator(shapes)
    can = {"model": CAN, "position": [0.0, 0.0, 0.0], "orientation": UPRIGHT, "static": True}
    for k in range(60):
        place = [0.6 * max(0.0, k / 30.0 - 0.5), 0.0, 0.0]
        message = {"t": k / 30.0, "hands": {"right": {"position": place}}, "objects": {"can": can}}
        for intention in estimator.update(igrip.Observation(**message)):
            if intention.probability:
                assert all(0.0 <= p <= 1.0 for p in intention.probability.values())
