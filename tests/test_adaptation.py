"""Adaptation to a person: what counts as wrong, and the long-run share of errors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.adaptation import AdaptationConfig, Person, ReachLearner
from igrip.commitment import CommitmentConfig, Committer
from igrip.evidence import Evidence

CONFIG = AdaptationConfig()
HOLDING = 0.12


def evidence(t, moving, cup=1.0, jug=1.0, confidence=0.0, trusted=True):
    """Return evidence of a hand at so many metres from two objects."""
    return Evidence(
        t=t, measured=t, position=(0.0, 0.0, 0.0), trusted=trusted, moving=moving, target="cup",
        grip="palmar", confidence={"cup": confidence, "jug": 0.0, "none": 1.0 - confidence},
        trusted_objects=frozenset({"cup", "jug"}), distances={"cup": cup, "jug": jug},
    )  # fmt: skip


def reach(learner, committed_to, rests_at, begin=0.0):
    """Let a hand move for a second, committed to something, and rest for another second."""
    for k in range(60):
        t, moving = begin + k / 30.0, k < 30
        near = {rests_at: 0.05} if rests_at and not moving else {}
        learner.update(evidence(t, moving, **near), committed_to if moving and k > 15 else None)


@pytest.mark.parametrize(
    ("committed_to", "rests_at", "reaches", "wrong"),
    [
        ("cup", "cup", 1, 0),
        ("cup", "jug", 1, 1),
        ("cup", None, 1, 1),  # it came to rest away from everything
        (None, "jug", 1, 0),  # nothing was risked
        (None, None, 0, 0),  # a movement to nowhere teaches nothing
    ],
)
def test_where_the_hand_comes_to_rest_is_the_label(committed_to, rests_at, reaches, wrong):
    person = Person()
    reach(ReachLearner(CONFIG, person, HOLDING), committed_to, rests_at)
    assert (person.reaches, person.wrong) == (reaches, wrong)
    assert person.margin == pytest.approx(reaches * CONFIG.step * (wrong - CONFIG.max_wrong))


def test_the_first_commitment_of_a_reach_counts():
    person = Person()
    learner = ReachLearner(CONFIG, person, HOLDING)
    for k, target in enumerate(["jug"] * 5 + ["cup"] * 5):
        learner.update(evidence(k / 30.0, moving=True), target)
    for k in range(10, 30):
        learner.update(evidence(k / 30.0, moving=False, cup=0.05), None)
    assert (person.reaches, person.wrong) == (1, 1)


def test_a_short_stop_on_the_way_is_not_the_end():
    person = Person()
    learner = ReachLearner(CONFIG, person, HOLDING)
    for k in range(30):
        learner.update(evidence(k / 30.0, moving=not 10 <= k < 15), "cup")
    assert person.reaches == 0


def test_a_veto_is_an_error_once():
    person = Person()
    learner = ReachLearner(CONFIG, person, HOLDING)
    learner.veto()  # nothing was committed to
    for k in range(10):
        learner.update(evidence(k / 30.0, moving=True), "cup")
    learner.veto()
    learner.veto()
    for k in range(10, 40):
        learner.update(evidence(k / 30.0, moving=False, jug=0.05), None)
    assert (person.reaches, person.wrong) == (1, 1)


@given(st.lists(st.booleans(), min_size=1, max_size=300))
def test_the_margin_stays_in_its_bounds_and_keeps_the_books(errors):
    person = Person()
    learner = ReachLearner(CONFIG, person, HOLDING)
    for n, wrong in enumerate(errors):
        reach(learner, "jug" if wrong else "cup", "cup", begin=2.5 * n)
    assert -CONFIG.max_fall <= person.margin <= CONFIG.max_rise
    assert (person.reaches, person.wrong) == (len(errors), sum(errors))


@pytest.mark.parametrize("hard", [0.1, 0.25])
def test_the_long_run_share_of_errors_is_the_accepted_one(hard):
    """A person whose confidences mean less than they say: errors fall with the threshold.

    The bound of Gibbs & Candès (2021) holds whatever the relation is, as long as no bound of the
    margin is met; here errors vanish within it.
    """
    random = np.random.default_rng(1)
    config = AdaptationConfig(step=0.02)
    person, reaches = Person(), 4000
    for _ in range(reaches):
        chance = max(0.0, hard - 1.5 * (person.margin - 0.0))  # of an error, by the margin
        wrong = bool(random.random() < chance)
        learner = ReachLearner(config, person, HOLDING)
        learner.update(evidence(0.0, moving=True), "jug" if wrong else "cup")
        for t in (1.0, 1.5):
            learner.update(evidence(t, moving=False, cup=0.05), None)
    width = config.max_rise + config.max_fall + config.step
    off = abs(person.wrong / reaches - config.max_wrong)
    assert off <= width / (config.step * reaches) + 1e-9


def committed_at(margin):
    """Return the lowest confidence that is committed to by a person with this margin."""
    for confidence in np.arange(0.3, 1.0, 0.01):
        committer = Committer(CommitmentConfig(), Person(margin=margin))
        leases = [
            committer.update(evidence(k / 30.0, moving=True, confidence=float(confidence)))
            for k in range(30)
        ]
        if any(leases):
            return float(confidence)
    return math.inf


def test_the_margin_moves_the_threshold():
    threshold = CommitmentConfig().threshold
    assert committed_at(0.0) == pytest.approx(threshold, abs=0.011)
    assert committed_at(-0.1) == pytest.approx(threshold - 0.1, abs=0.011)
    assert committed_at(0.1) == pytest.approx(threshold + 0.1, abs=0.011)
    assert committed_at(0.3) == pytest.approx(0.98, abs=0.011)  # the highest that can be reached


def test_a_person_without_reaches_changes_nothing():
    plain, with_person = Committer(CommitmentConfig()), Committer(CommitmentConfig(), Person())
    for k in range(60):
        one = evidence(k / 30.0, moving=k < 40, cup=1.0 - k / 60.0, confidence=k / 40.0)
        assert plain.update(one) == with_person.update(one)
        assert plain.state == with_person.state
