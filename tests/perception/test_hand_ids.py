"""Hands keep their ids whatever they are called, and in whatever order they come."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.perception.hand_ids import HandIdConfig, HandIdTracker, PalmMeasurement

RATE = 30.0
seeds = st.integers(0, 2**32 - 1)


def paths(rng, frames=120):
    """Return how two hands move, (2, frames, 3): smoothly, past each other, far in depth."""
    s = np.linspace(0.0, 1.0, frames)
    s = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    gap = rng.uniform(0.15, 0.4)
    starts = np.array([[0.25, 0.0, 0.6], [-0.25, 0.0, 0.6 + gap]])
    ends = starts[::-1].copy()
    ends[:, 2] = starts[:, 2]  # they change sides, each at its own depth
    return starts[:, None] + (ends - starts)[:, None] * s[:, None]


def follow(rng, hands, flips=0.3, drops=0.2, noise=0.004, labels=("right", "left"), config=None):
    """Return which true hand each id was, frame by frame."""
    identities = HandIdTracker(config)
    history = []
    for k in range(hands.shape[1]):
        true = [h for h in range(len(hands)) if k < 6 or rng.random() >= drops]
        rng.shuffle(true)
        seen = []
        for h in true:
            label = labels[h]
            if k >= 6 and rng.random() < flips:
                label = labels[1 - h]
            seen.append(PalmMeasurement(hands[h, k] + rng.normal(0.0, noise, 3), label, 0.9))
        said = identities.update(k / RATE, seen)
        indices = [i for i in said.values() if i is not None]
        assert len(indices) == len(set(indices))  # no hand has two ids
        known = {id: true[i] for id, i in said.items() if i is not None}
        assert k < 2 or len(known) == len(true)  # and every hand that is seen has one
        history.append(known)
    return history


@given(seed=seeds)
def test_ids_stay_through_crossings_flips_dropouts_and_any_order(seed):
    rng = np.random.default_rng(seed)
    history = follow(rng, paths(rng))
    assert history[1] == {}
    for known in history[2:]:
        assert known.items() <= {"right": 0, "left": 1}.items()


@given(seed=seeds)
def test_mirrored_labels_mirror_the_ids_and_change_nothing_else(seed):
    plain_rng, mirror_rng = np.random.default_rng(seed), np.random.default_rng(seed)
    plain = follow(plain_rng, paths(plain_rng))
    mirror = follow(mirror_rng, paths(mirror_rng), labels=("left", "right"))
    other = {"left": "right", "right": "left"}
    assert [{other[id]: h for id, h in known.items()} for known in plain] == mirror


@given(seed=seeds)
def test_hands_called_the_same_have_two_ids(seed):
    rng = np.random.default_rng(seed)
    history = follow(rng, paths(rng), flips=0.0, labels=("left", "left"))
    assert set(history[5]) == {"left", "right"}
    for known in history[2:]:
        assert known.items() <= history[5].items()


def test_a_repeated_find_of_a_hand_is_not_a_second_hand():
    identities = HandIdTracker()
    for k in range(30):
        at = np.array([0.01 * k, 0.0, 0.6])
        seen = (
            [PalmMeasurement(at, "right"), PalmMeasurement(at + 0.005, "left")]
            if k > 4
            else [PalmMeasurement(at)]
        )
        said = identities.update(k / RATE, seen)
    assert said == {"right": 0}


def test_what_is_seen_once_or_twice_is_no_hand():
    identities = HandIdTracker()
    at = np.array([0.0, 0.0, 0.6])
    for k in range(60):
        seen = [PalmMeasurement(at, "left")] if k % 3 else []
        assert identities.update(k / RATE, seen) == {}


def test_a_hand_that_is_not_seen_is_waited_for_and_then_forgotten():
    identities = HandIdTracker()
    at = np.array([0.0, 0.0, 0.6])
    for k in range(5):
        identities.update(k / RATE, [PalmMeasurement(at, "left")])
    assert identities.update(0.5, []) == {"left": None}
    assert identities.update(0.6, [PalmMeasurement(at + 0.05, "right")]) == {"left": 0}
    assert identities.update(1.7, []) == {}


def test_a_ghost_across_the_room_does_not_take_the_id():
    identities = HandIdTracker()
    for k in range(5):
        identities.update(k / RATE, [PalmMeasurement(np.array([0.0, 0.0, 0.6]), "left")])
    for k in range(5, 20):
        said = identities.update(k / RATE, [PalmMeasurement(np.array([0.9, 0.0, 1.5]), "left")])
        assert said["left"] is None


def test_time_that_goes_back_forgets_everything():
    identities = HandIdTracker()
    for k in range(5):
        identities.update(10.0 + k / RATE, [PalmMeasurement(np.zeros(3), "left")])
    assert identities.update(0.0, [PalmMeasurement(np.zeros(3), "right")]) == {}


@pytest.mark.parametrize("most", [1, 2, 3, 4])
def test_there_are_never_more_ids_than_hands_may_be(most):
    identities = HandIdTracker(HandIdConfig(max_hands=most))
    for k in range(6):
        seen = [PalmMeasurement(np.array([0.3 * i, 0.0, 0.6]), "left") for i in range(5)]
        said = identities.update(k / RATE, seen)
    assert len(said) == most
    assert len(set(said.values())) == most


@given(speed=st.floats(0.5, 3.0))
def test_a_fast_hand_is_followed(speed):
    identities = HandIdTracker()
    for k in range(30):
        at = np.array([max(k - 4, 0) * speed / RATE, 0.0, 0.6])
        said = identities.update(k / RATE, [PalmMeasurement(at, "right")])
    assert said == {"right": 0}
