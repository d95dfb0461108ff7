"""The second generator of reaches: paths that begin and end where they should, seeded."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from training.arm_movement import STEP, carry, draw_arm, move
from training.arms import TRIALS, draw_places, simulate_arm

START, GOAL = np.array([0.1, 0.05, 0.05]), np.array([-0.1, 0.45, 0.15])


def arms(count=20):
    for seed in range(count):
        random = np.random.default_rng(seed)
        yield draw_arm(random), random


def test_a_movement_begins_at_its_start_and_ends_at_its_goal():
    """In one of ten, the last submovement is cut off before it has died away."""
    misses = []
    for arm, random in arms(40):
        path = move(arm, START, GOAL, random)
        assert np.linalg.norm(path[0] - START) < 0.03
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() / STEP < 4.0  # m/s
        misses.append(np.linalg.norm(path[-1] - GOAL))
    assert np.median(misses) < 0.02
    assert np.quantile(misses, 0.85) < 0.05


def test_impaired_people_are_slower():
    lengths = {False: [], True: []}
    for arm, random in arms(60):
        lengths[arm.impaired].append(len(move(arm, START, GOAL, random)))
    assert np.median(lengths[True]) > 1.5 * np.median(lengths[False])


def test_a_device_lags_behind_and_arrives():
    arm = replace(next(arms())[0], lag=0.1, damping=1.0)
    path = np.concatenate([np.zeros((1, 3)), np.tile([0.1, 0.0, 0.0], (240, 1))])
    carried = carry(arm, path)
    # a critically damped spring: x = 1 - (1 + t / lag) exp(-t / lag)
    for k in (12, 24, 48):
        t = k * STEP / 0.1
        assert carried[k, 0] == pytest.approx(0.1 * (1 - (1 + t) * math.exp(-t)), abs=0.004)
    assert carried[-1] == pytest.approx([0.1, 0.0, 0.0], abs=1e-4)
    assert carry(replace(arm, lag=0.0), path) is path


@pytest.mark.parametrize("kind", ["table", "plane", "wall", "line", "circle", "space"])
def test_places_find_room(kind):
    places = draw_places(kind, 12, np.random.default_rng(3))
    gaps = np.linalg.norm(places[:, None] - places[None], axis=2)[np.triu_indices(12, 1)]
    assert places.shape == (12, 3)
    assert gaps.min() > 0.01
    if kind == "plane":
        assert (places[:, 2] == 0.0).all()


def test_people_are_seeded_and_their_reaches_lie_within_their_recordings():
    recordings = [r for number in range(6) for r in simulate_arm(1, number)]
    again = simulate_arm(1, 2)
    assert 30 < len(recordings) <= 6 * TRIALS
    same = [r for r in recordings if r.person == "a2"]
    assert [m.to_json() for r in again for m in r.messages] == [
        m.to_json() for r in same for m in r.messages
    ]
    reaches = [r for r in recordings if r.target is not None]
    assert len(reaches) > 15
    for recording in reaches:
        assert 0.0 <= recording.onset < recording.end <= recording.messages[-1].t + 0.1
