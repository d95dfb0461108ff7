"""How simulated people move: smooth, from where they rest to where they mean to be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.lab.simulation.movement import (
    SimulatedReach,
    Submovement,
    draw_habits,
    draw_reach,
    sway,
    tremor,
)
from igrip.lab.simulation.parameters import PersonParameters, cohort_parameters

START, GOAL = np.array([0.2, 0.0, 0.04]), np.array([-0.1, 0.4, 0.1])


def drawn(seed, person=None, other=None):
    random = np.random.default_rng(seed)
    person = person or PersonParameters()
    return draw_reach(person, draw_habits(person, random), START, GOAL, 1.0, other, random)


def test_one_submovement_by_hand():
    move = Submovement(1.0, 2.0, np.array([0.4, 0.0, 0.0]))
    t = np.array([0.0, 1.0, 2.0, 3.0, 9.0])
    assert move.done(t) == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])
    early = Submovement(1.0, 2.0, np.array([0.4, 0.0, 0.0]), peak_time=0.4)
    assert early.done(np.array([1.8])) == pytest.approx([0.5])
    path = SimulatedReach(np.zeros(3), [move], np.array([0.0, 0.0, 0.05]), 3.0).position(t)
    assert path[:, 0] == pytest.approx([0.0, 0.0, 0.2, 0.4, 0.4])
    assert path[:, 2] == pytest.approx([0.0, 0.0, 0.05, 0.0, 0.0])


@given(st.integers(0, 10_000), st.sampled_from(["healthy", "stroke", "sci"]))
def test_every_reach_begins_at_rest_and_ends_near_its_goal(seed, profile):
    person = cohort_parameters(profile).person
    reach = drawn(seed, person, other=np.array([0.3, 0.3, 0.1]))
    assert reach.position(np.array([0.0, 1.0])) == pytest.approx(np.tile(START, (2, 1)))
    end = reach.position(np.array([reach.end, reach.end + 5.0]))
    assert end[0] == pytest.approx(end[1])
    assert np.linalg.norm(end[0] - GOAL) < 6 * person.end_error
    t = np.arange(0.0, reach.end, 0.01)
    steps = np.linalg.norm(np.diff(reach.position(t), axis=0), axis=1) / 0.01
    assert steps.max() < 5.0  # no leaps


def test_a_change_of_mind_begins_towards_the_other():
    person = PersonParameters(change_of_mind=1.0, submovements=0.0, hesitation=0.0, change_at=0.7)
    other = np.array([0.6, 0.4, 0.1])
    towards = 0
    for seed in range(20):
        early = drawn(seed, person, other).position(np.array([1.45]))[0] - START
        towards += early @ (other - START) > early @ (GOAL - START)
    assert towards == 20


def test_a_hesitation_takes_time():
    calm, torn = PersonParameters(hesitation=0.0), PersonParameters(hesitation=1.0)
    assert all(drawn(k, torn).end > drawn(k, calm).end + 0.1 for k in range(20))


def test_tremor_and_sway_have_their_size():
    t = np.arange(0.0, 60.0, 1 / 200)
    rng = np.random.default_rng(0)
    shaken = np.concatenate([tremor(PersonParameters(), t, rng) for _ in range(20)])
    assert np.sqrt((shaken**2).mean()) == pytest.approx(0.0004 / np.sqrt(2), rel=0.3)
    drift = np.concatenate([sway(PersonParameters(), t, rng) for _ in range(20)])
    assert 0.0003 < drift.std() < 0.003
    assert np.abs(np.diff(drift[: len(t)], axis=0)).max() < 1e-4  # slow
