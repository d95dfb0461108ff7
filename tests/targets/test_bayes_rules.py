"""The rules of the posterior one by one, with a scorer whose answers are given."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.targets.bayes import (
    FLOOR,
    MAX_REST_STEP,
    REST_TIME_CONSTANT,
    SWITCH_RATE,
    Bayes,
    pool,
    resting_posterior,
)
from igrip.targets.learned.features import SHARED, Features

MEMORY = 0.05


def estimator(monkeypatch, scores):
    """Return an estimator whose scorer gives these log-odds by id, whatever the movement."""
    monkeypatch.setattr(
        "igrip.targets.bayes.features_of",
        lambda reach, cylinders: Features(cylinders, np.zeros(len(SHARED))),
    )

    def score(features):
        return np.array([scores[id] for id in features.local], dtype=float)

    scorer = SimpleNamespace(memory=MEMORY, score=score)
    return Bayes(scorer)


def frame(t, ids, moving, may_move=None):
    """Return motion and geometry of one frame."""
    may_move = moving if may_move is None else may_move
    reach = SimpleNamespace(moving=moving, may_move=may_move)
    objects = [SimpleNamespace(id=id) for id in ids]
    return (
        SimpleNamespace(t=t, reach=reach),
        SimpleNamespace(objects=objects, cylinders=lambda: list(ids)),
        {},
    )


def pooled(posterior, scores, dt):
    """Return the stated formula in plain numpy."""
    keep, switch = math.exp(-dt / MEMORY), 1.0 - math.exp(-SWITCH_RATE * dt)
    n = len(posterior)
    logs = keep * np.log((1 - switch) * posterior + switch / n)
    logs += (1 - keep) * np.append(scores, 0.0)
    shares = np.exp(logs - logs.max())
    return (shares / shares.sum() + FLOOR / n) / (1.0 + FLOOR)


def test_a_moving_hand_is_pooled_by_the_formula(monkeypatch):
    scores = {"a": 2.0, "b": -1.0}
    bayes, expected = estimator(monkeypatch, scores), resting_posterior(2)
    bayes.update(*frame(1.0, "ab", moving=False))
    for t, before in ((1.02, 1.0), (1.1, 1.02), (1.5, 1.1)):
        expected = pooled(expected, [2.0, -1.0], t - before)
        found = bayes.update(*frame(t, "ab", moving=True))
        assert found.probability == pytest.approx(expected, rel=1e-9)
        assert found.scores == pytest.approx(expected[:-1], rel=1e-9)


def test_the_first_frame_of_a_stream_has_no_time_to_pool(monkeypatch):
    bayes = estimator(monkeypatch, {"a": 50.0})
    found = bayes.update(*frame(9.0, "a", moving=True))
    assert found.probability == pytest.approx(resting_posterior(1), abs=2 * FLOOR)


def test_a_target_may_switch_at_the_stated_rate():
    """After a long time without evidence, every outcome is as likely as any other."""
    posterior = np.array([0.98, 0.01, 0.01])
    for _ in range(20_000):
        pool(posterior, np.zeros(2), 1.0, 1.0 - math.exp(-SWITCH_RATE * 0.01))
    assert posterior == pytest.approx(np.full(3, 1.0 / 3.0), abs=1e-3)
    assert 0.02 < SWITCH_RATE < 0.5  # once in two seconds to a minute


def test_a_switch_keeps_a_certain_posterior_open(monkeypatch):
    """With a change of mind ruled out, what was certain would stay so against any evidence."""
    bayes = estimator(monkeypatch, {"a": 30.0, "b": -30.0})
    bayes.update(*frame(0.0, "ab", moving=False))
    for k in range(1, 30):
        bayes.update(*frame(0.1 * k, "ab", moving=True))
    certain = bayes._posterior.copy()
    pool(bayes._posterior, np.zeros(2), 1.0, 1.0 - math.exp(-SWITCH_RATE))
    assert bayes._posterior[1] == pytest.approx((1.0 - math.exp(-SWITCH_RATE)) / 3.0, rel=0.01)
    assert certain[1] < 1e-6


@pytest.mark.parametrize("dt", [0.01, 0.5 * MAX_REST_STEP, MAX_REST_STEP])
def test_a_resting_hand_forgets_with_the_time_constant(monkeypatch, dt):
    bayes = estimator(monkeypatch, {"a": 3.0, "b": 0.0})
    start = moved(bayes)
    found = bayes.update(*frame(1.0 + dt, "ab", moving=False)).probability
    keep = math.exp(-dt / REST_TIME_CONSTANT)
    assert found == pytest.approx(keep * start + (1.0 - keep) * resting_posterior(2), rel=1e-9)


@pytest.mark.parametrize("gap", [2.0 * MAX_REST_STEP, 1.0, 60.0])
def test_a_gap_counts_as_no_more_than_one_step_of_rest(monkeypatch, gap):
    """The hand was not observed: it may have reached and come back."""
    bayes = estimator(monkeypatch, {"a": 3.0, "b": 0.0})
    start = moved(bayes)
    found = bayes.update(*frame(1.0 + gap, "ab", moving=False)).probability
    keep = math.exp(-MAX_REST_STEP / REST_TIME_CONSTANT)
    assert found == pytest.approx(keep * start + (1.0 - keep) * resting_posterior(2), rel=1e-9)
    assert 0.05 <= MAX_REST_STEP <= 0.2  # longer than between two frames of a slow camera


def moved(bayes):
    """Let the hand move until 1 s; return the posterior."""
    bayes.update(*frame(0.9, "ab", moving=False))
    for k in range(1, 11):
        found = bayes.update(*frame(0.9 + 0.01 * k, "ab", moving=True))
    return found.probability


@pytest.mark.parametrize(
    ("before", "may_move", "pools"),
    [("none", True, True), ("none", False, False), ("a", True, False), ("a", False, False)],
)
def test_a_resting_hand_that_may_move_is_looked_at_unless_it_has_arrived(
    monkeypatch, before, may_move, pools
):
    """One that trembles at the object that it has reached keeps it."""
    scores = {"a": 5.0 if before == "a" else -5.0, "b": -5.0}
    bayes = estimator(monkeypatch, scores)
    start = moved(bayes)
    assert (start[0] > start[-1]) == (before == "a")
    scores |= {"a": 0.0, "b": 4.0}
    found = bayes.update(*frame(1.2, "ab", moving=False, may_move=may_move)).probability
    rested = math.exp(-MAX_REST_STEP / REST_TIME_CONSTANT)
    expected = (
        pooled(start, [0.0, 4.0], 0.2)
        if pools
        else rested * start + (1.0 - rested) * resting_posterior(2)
    )
    assert found == pytest.approx(expected, rel=1e-6)


def test_a_hand_that_trembles_at_the_only_object_keeps_it(monkeypatch):
    scores = {"a": 5.0}
    bayes = estimator(monkeypatch, scores)
    bayes.update(*frame(0.0, "a", moving=False))
    assert bayes.update(*frame(1.0, "a", moving=True)).probability[0] > 0.9
    scores["a"] = -5.0
    assert bayes.update(*frame(1.1, "a", moving=False, may_move=True)).probability[0] > 0.8


@pytest.mark.parametrize(
    ("score", "moving", "target"),
    [(-3.0, True, 0), (-4.0, True, None), (0.5, False, 0), (-0.5, False, None)],
)
def test_the_target_of_a_moving_hand_may_be_less_likely_than_none(
    monkeypatch, score, moving, target
):
    """Log-odds of -3 leave none at 0.95, of -4 at 0.98; the limit is 0.97."""
    bayes = estimator(monkeypatch, {"a": score})
    bayes.update(*frame(0.0, "a", moving=False))
    found = bayes.update(*frame(3.0, "a", moving=True))
    if not moving:
        found = bayes.update(*frame(3.0, "a", moving=False))
    assert found.target == target


@pytest.mark.parametrize(
    ("none", "moving", "target"),
    [(0.97, True, 0), (0.9701, True, None), (0.5, False, 0), (0.501, False, None)],
)
def test_none_may_be_as_likely_as_its_limit(monkeypatch, none, moving, target):
    bayes = estimator(monkeypatch, {"a": 0.0})
    bayes.update(*frame(0.0, "a", moving=False))
    bayes._posterior[:] = 1.0 - none, none
    assert bayes.update(*frame(0.0, "a", moving)).target == target


def test_the_familiarity_is_that_of_a_movement(monkeypatch):
    bayes = estimator(monkeypatch, {"a": -5.0})
    assert bayes.update(*frame(0.0, "a", moving=False)).familiarity is None
    strange = bayes.update(*frame(0.1, "a", moving=True)).familiarity
    assert 0.0 <= strange <= 1.0
    assert bayes.update(*frame(0.2, "a", moving=False)).familiarity is None


def test_no_object_no_target(monkeypatch):
    bayes = estimator(monkeypatch, {})
    for moving in (False, True):
        found = bayes.update(*frame(1.0, "", moving))
        assert found.target is None
        assert found.probability.tolist() == [1.0]


def test_what_vanishes_goes_to_none_and_what_stays_keeps_its_share(monkeypatch):
    bayes = estimator(monkeypatch, {"a": 3.0, "b": 1.0, "c": 0.0})
    start = moved(bayes)
    found = bayes.update(*frame(1.0, "a", moving=False)).probability
    assert found == pytest.approx([start[0], 1.0 - start[0]], abs=1e-12)


def test_the_order_of_the_objects_does_not_matter(monkeypatch):
    bayes = estimator(monkeypatch, {"a": 3.0, "b": 1.0})
    start = moved(bayes)
    found = bayes.update(*frame(1.0, "ba", moving=False)).probability
    assert found == pytest.approx(start[[1, 0, 2]], abs=1e-12)


def test_an_object_that_appears_begins_at_next_to_nothing(monkeypatch):
    bayes = estimator(monkeypatch, {"a": 3.0, "b": 1.0, "c": 9.0})
    start = moved(bayes)
    found = bayes.update(*frame(1.0, "abc", moving=False)).probability
    assert found[2] == pytest.approx(FLOOR, rel=0.01)
    assert found[:2] == pytest.approx(start[:2], abs=1e-5)
    assert found.sum() == pytest.approx(1.0, abs=1e-12)


@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(1, 6))
def test_whatever_comes_and_goes_it_stays_a_probability(seed, before, after):
    """The sum of what is carried over never exceeds one, however much of it there is."""
    rng = np.random.default_rng(seed)
    bayes = Bayes(SimpleNamespace(memory=MEMORY, score=None))
    bayes._follow_objects([f"e{k}" for k in range(before)])
    shares = rng.random(before + 1) * np.append(np.ones(before), rng.choice([0.0, 1.0]))
    bayes._posterior = shares / shares.sum()
    ids = [f"e{k}" for k in rng.permutation(8)[:after]]
    kept = {f"e{k}": bayes._posterior[k] for k in range(before)}
    bayes._follow_objects(ids)
    found = bayes._posterior
    assert found.sum() == pytest.approx(1.0, abs=1e-12)
    assert (found >= 0.0).all()
    for id, value in zip(ids, found, strict=False):
        assert value == pytest.approx(kept.get(id, FLOOR), rel=1e-4, abs=1e-9)


def test_a_first_object_gets_the_posterior_of_a_resting_hand(monkeypatch):
    bayes = estimator(monkeypatch, {"a": 0.0})
    bayes.update(*frame(1.0, "", moving=True))
    found = bayes.update(*frame(1.0, "a", moving=False)).probability
    assert found == pytest.approx(resting_posterior(1))
    assert found == pytest.approx([1.0 / 3.0, 2.0 / 3.0])  # one object: none is twice as likely


@pytest.mark.parametrize(
    ("objects", "none"), [(1, 2 / 3), (2, 0.5), (3, 0.4), (10, 0.4), (100, 0.4)]
)
def test_none_of_a_resting_hand(objects, none):
    posterior = resting_posterior(objects)
    assert posterior[-1] == pytest.approx(none)
    assert posterior[:-1] == pytest.approx(np.full(objects, (1.0 - none) / objects))
