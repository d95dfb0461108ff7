"""Objects that a hand carries, by their velocities; and that a hand that carries one is full."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import igrip
from igrip.commitment import CommitmentConfig, Committer
from igrip.evidence import MIN_CARRY_COSINE, carried_objects
from support import BOX, CAN, UPRIGHT
from test_commitment import committed, evidence

LIMIT = math.degrees(math.acos(MIN_CARRY_COSINE))


@pytest.mark.parametrize("speed", [0.06, 0.5, 3.0])
@pytest.mark.parametrize(
    ("degrees", "carried"),
    [(0.0, True), (LIMIT - 1.0, True), (LIMIT + 1.0, False), (90.0, False), (180.0, False)],
)
def test_an_object_is_carried_if_it_moves_in_the_direction_of_the_hand(speed, degrees, carried):
    angle = math.radians(degrees)
    own = speed * np.array([math.cos(angle), 0.0, math.sin(angle)])
    assert carried_objects({"cup": own.tolist()}, (0.4, 0.0, 0.0)) == (["cup"] if carried else [])


def test_people_carry_within_half_of_a_right_angle_and_not_across():
    assert 45.0 < LIMIT < 60.0


@given(st.integers(0, 10_000), st.floats(0.01, 10.0), st.floats(0.01, 10.0))
def test_only_the_angle_between_the_velocities_matters(seed, own_scale, hand_scale):
    rng = np.random.default_rng(seed)
    hand, own = rng.normal(size=3), rng.normal(size=3)
    cosine = hand @ own / np.linalg.norm(hand) / np.linalg.norm(own)
    found = carried_objects({"cup": own_scale * own}, hand_scale * hand)
    if abs(cosine - MIN_CARRY_COSINE) > 1e-9:
        assert (found == ["cup"]) == (cosine > MIN_CARRY_COSINE)


@pytest.mark.parametrize(("own", "hand"), [((0, 0, 0), (1, 0, 0)), ((1, 0, 0), (0, 0, 0))])
def test_what_rests_is_not_carried(own, hand):
    assert carried_objects({"cup": own}, hand) == []


def test_velocities_have_three_components():
    with pytest.raises(ValueError, match="longer"):
        carried_objects({"cup": (1.0, 0.0)}, (1.0, 0.0, 0.0))


REACTIVE = CommitmentConfig(reliability=0.0, holding_distance=0.125)


@pytest.mark.parametrize(
    ("distances", "full"),
    [
        ({"cup": 0.3, "jug": 0.05}, True),
        ({"cup": 0.3, "jug": 0.125}, True),  # just at the distance of holding
        ({"cup": 0.3, "jug": 0.126}, False),  # it moves along, but out of the hand
        ({"cup": 0.3}, False),  # where it is, is not known
    ],
)
def test_a_hand_that_carries_something_is_full(distances, full):
    committer = Committer(REACTIVE)
    carrying = evidence(0.1, distances=distances, carried=["jug"])
    assert (committer.update(carrying) is None) == full
    assert committer.update(evidence(0.2, distances=distances)) is not None


def test_a_hand_that_begins_to_carry_loses_what_it_was_earning():
    committer = Committer(CommitmentConfig(reliability=0.5))
    committer.update(evidence(0.0))
    assert committer.state == "earning"
    committer.update(evidence(0.03, distances={"cup": 0.3, "jug": 0.05}, carried=["jug"]))
    assert committer.state == "open"


def test_what_is_carried_does_not_end_a_commitment():
    """The target itself moves along with the hand that takes it away."""
    committer = Committer(REACTIVE)
    t = committed(committer)
    lifted = evidence(t + 0.03, distances={"cup": 0.05, "jug": 0.4}, carried=["cup"])
    assert committer.update(lifted) is not None


@pytest.mark.parametrize("carries", [False, True])
def test_a_hand_with_an_object_in_it_commits_to_no_other(shapes, carries):
    """The whole way: the can moves with the hand towards the box."""
    config = igrip.Config(targets="distance", commitment={"reliability": 0.0})
    estimator = igrip.Estimator(shapes, config)
    leases = []
    for k in range(40):
        x = 0.01 * max(0, k - 10)
        can = [x, 0.0, 0.0] if carries else [0.0, 0.6, 0.0]
        message = igrip.Observation(
            t=k / 30.0,
            hands={"right": {"position": [x, 0.0, 0.08 + 1e-4 * (k % 3)]}},
            objects={
                "can": {"model": CAN, "position": can, "orientation": UPRIGHT},
                "box": {"model": BOX, "position": [0.5, 0.0, 0.0], "orientation": UPRIGHT},
            },
        )
        [intention] = estimator.update(message)
        leases.append(intention.commitment)
    targets = {lease.target for lease in leases if lease is not None}
    assert ("box" in targets) == (not carries)


def test_evidence_can_be_sent_to_another_process():
    one = evidence(0.0)
    assert pickle.loads(pickle.dumps(one)) == one
    held = one._replace(held={"mug": "left"})
    assert pickle.loads(pickle.dumps(held)).held == {"mug": "left"}
