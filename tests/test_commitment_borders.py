"""The lease of one hand exactly at its limits, with numbers that binary floats hold exactly."""

from __future__ import annotations

import pytest

from igrip.commitment import CommitmentConfig, Committer
from test_commitment import evidence

EXACT = CommitmentConfig(
    reliability=0.0, min_threshold=0.5, hysteresis=0.25, lease_duration=0.25, max_pause=0.5,
    veto_rest_duration=0.25, holding_distance=0.125, release_margin=0.0625,
)  # fmt: skip
STEP = 0.0625
NEAR, FAR = {"cup": 0.0625, "jug": 0.5}, {"cup": 0.5, "jug": 0.5}


def committed(config=EXACT):
    """Return a committer with a commitment to the cup at 1 s."""
    committer = Committer(config)
    assert committer.update(evidence(1.0)) is not None
    return committer


def holding():
    """Return a committer that holds the cup since 1 s + STEP."""
    committer = committed()
    committer.update(evidence(1.0 + STEP, moving=False, distances=NEAR))
    assert committer.state == "holding"
    return committer


@pytest.mark.parametrize(("confidence", "leased"), [(0.5, True), (0.499, False)])
def test_the_threshold_itself_is_enough(confidence, leased):
    lease = Committer(EXACT).update(evidence(1.0, {"cup": confidence, "jug": 0.1}))
    assert (lease is not None) == leased


@pytest.mark.parametrize(("reliability", "threshold"), [(0.0, 0.6), (0.5, 0.7), (1.0, 0.8)])
def test_threshold_and_dwell_grow_linearly_with_reliability(reliability, threshold):
    config = CommitmentConfig(
        reliability=reliability, min_threshold=0.6, max_threshold=0.8, max_dwell=0.4
    )
    assert config.threshold == pytest.approx(threshold)
    assert config.dwell == pytest.approx(0.4 * reliability)


def test_a_target_without_a_confidence_is_not_committed_to():
    assert Committer(EXACT).update(evidence(1.0, {"jug": 0.9}, target="cup",
                                            trusted_objects={"cup", "jug"})) is None  # fmt: skip


@pytest.mark.parametrize("missing", ["target", "grip"])
def test_without_target_or_grip_there_is_no_lease(missing):
    committer = Committer(EXACT)
    assert committer.update(evidence(1.0, **{missing: None})) is None
    assert committer.state == "open"


@pytest.mark.parametrize(
    ("kept", "confidence"),
    [(True, {"cup": 0.25}), (False, {"cup": 0.249}), (False, {"jug": 0.1})],
)
def test_hysteresis_itself_keeps_a_target(kept, confidence):
    committer = committed()
    lease = committer.update(evidence(1.0 + STEP, confidence, trusted_objects={"cup"}))
    assert (lease is not None) == kept


def test_a_full_dwell_is_needed_counted_in_measurements():
    config = CommitmentConfig(
        reliability=1.0, max_threshold=0.9, max_dwell=0.5, lease_duration=0.3, max_pause=1.0
    )
    committer = Committer(config)
    assert committer.update(evidence(1.0)) is None
    almost = 1.0 + config.dwell - 1e-6
    assert committer.update(evidence(almost)) is None
    assert committer.update(evidence(1.6, measured=almost)) is None  # it arrived late
    assert committer.update(evidence(1.6 + STEP, measured=1.5)) is not None


@pytest.mark.parametrize(("measured", "leased"), [(0.7501, True), (0.75, False), (0.5, False)])
def test_a_lease_that_would_have_ended_is_not_given(measured, leased):
    lease = Committer(EXACT).update(evidence(1.0, measured=measured))
    assert (lease is not None) == leased
    if lease:
        assert lease.valid_until == measured + 0.25


@pytest.mark.parametrize(("pause", "state"), [(0.5, "committed"), (0.5 + STEP, "open")])
def test_a_pause_may_last_its_full_limit(pause, state):
    committer = committed()
    committer.update(evidence(1.0 + pause, trusted=False))
    assert committer.state == state


@pytest.mark.parametrize(("pause", "leased"), [(0.5, True), (0.5 + STEP, False)])
def test_a_hold_lapses_after_the_full_pause(pause, leased):
    committer = holding()
    back = evidence(1.0 + STEP + pause, moving=False, distances=NEAR)
    assert (committer.update(back) is not None) == leased
    assert committer.state == "holding"


@pytest.mark.parametrize(("distance", "state"), [(0.125, "holding"), (0.126, "open")])
def test_a_hand_holds_up_to_the_holding_distance(distance, state):
    committer = committed()
    committer.update(evidence(1.0 + STEP, moving=False, distances={"cup": distance}))
    assert committer.state == state


def test_a_hand_that_stops_where_its_target_is_not_known_holds_nothing():
    committer = committed()
    committer.update(evidence(1.0 + STEP, moving=False, distances={"jug": 0.01}))
    assert committer.state == "open"


@pytest.mark.parametrize(
    ("distance", "kept"), [(0.125, True), (0.1875, True), (0.188, False), (0.5, False)]
)
def test_a_hold_ends_beyond_holding_distance_and_margin(distance, kept):
    committer = holding()
    committer.update(evidence(1.0 + 2 * STEP, {"cup": 0.3}, distances={"cup": distance}))
    assert (committer.state == "holding") == kept


@pytest.mark.parametrize(
    ("x", "known", "kept"),
    [(0.03, False, True), (0.0625, False, True), (0.063, False, False), (0.5, True, True)],
)
def test_a_hidden_object_is_left_only_if_it_is_unknown_and_the_hand_elsewhere(x, known, kept):
    committer = holding()
    distances = {"cup": 0.5} if known else {"jug": 0.5}
    hidden = evidence(1.0 + 2 * STEP, {"cup": 0.3}, position=(x, 0.0, 0.0), distances=distances,
                      trusted_objects=set())  # fmt: skip
    committer.update(hidden)
    assert (committer.state == "holding") == kept


def test_the_grip_follows_the_estimate_of_the_target_alone():
    committer = committed()
    leases = [
        committer.update(evidence(1.0 + k * STEP, confidence, grip=grip))
        for k, (grip, confidence) in enumerate([
            ("pinch", {"cup": 0.9}), (None, {"cup": 0.9}), ("palmar", {"cup": 0.4, "jug": 0.6}),
            ("palmar", {"cup": 0.4, "apple": 0.6}),
        ], start=1)
    ]  # fmt: skip
    assert [lease.grip for lease in leases] == ["pinch"] * 4
    assert {lease.since for lease in leases} == {1.0}


def test_what_is_held_keeps_its_grip():
    committer = holding()
    lease = committer.update(evidence(1.0 + 2 * STEP, moving=False, grip="pinch", distances=NEAR))
    assert lease.grip == "palmar"


@pytest.mark.parametrize("prepare", [committed, holding])
def test_a_rejected_measurement_ends_no_lease(prepare):
    committer = prepare()
    state = committer.state
    committer.reject()
    assert committer.state == state


def test_a_released_device_ends_no_commitment():
    committer = committed()
    committer.notify_released()
    assert committer.state == "committed"


def vetoed():
    """Return a committer whose hand was vetoed at 1 s and rests from then on."""
    committer = committed()
    committer.veto()
    assert committer.update(evidence(1.0 + STEP, moving=False)) is None
    return committer


@pytest.mark.parametrize(("rest", "over"), [(0.25, True), (0.25 - STEP, False)])
def test_a_veto_is_over_after_the_full_rest(rest, over):
    committer = vetoed()
    committer.update(evidence(1.0 + STEP + rest, moving=False))
    assert committer.vetoed != over
    assert (committer.update(evidence(1.5 + STEP)) is not None) == over


@pytest.mark.parametrize(("gap", "over"), [(0.5, True), (0.5 + STEP, False)])
def test_a_rest_may_not_have_gaps_longer_than_a_pause(gap, over):
    committer = vetoed()
    committer.update(evidence(1.0 + STEP + gap, moving=False))
    assert committer.vetoed != over


def test_a_movement_interrupts_the_rest():
    committer = vetoed()
    committer.update(evidence(1.0 + 3 * STEP))
    committer.update(evidence(1.0 + 4 * STEP, moving=False))
    assert committer.vetoed
    committer.update(evidence(1.0 + 8 * STEP, moving=False))
    assert not committer.vetoed


ASKING = EXACT.model_copy(update={"needs_confirmation": True})


def test_a_confirmation_is_void_after_a_rest():
    committer = Committer(ASKING)
    committer.confirm()
    for k in range(6):
        committer.update(evidence(1.0 + k * STEP, moving=False))
    assert committer.update(evidence(1.5)) is None
    committer.confirm()
    assert committer.update(evidence(1.5 + STEP)) is not None


def test_a_confirmation_while_holding_is_for_the_next_reach():
    committer = Committer(ASKING)
    committer.confirm()
    assert committer.update(evidence(1.0)) is not None
    for k in range(1, 8):
        committer.update(evidence(1.0 + k * STEP, moving=False, distances=NEAR))
    assert committer.state == "holding"
    committer.confirm()
    committer.update(evidence(1.5, moving=False, distances=NEAR))
    other = {"jug": 0.9, "cup": 0.05}
    assert committer.update(evidence(1.5 + STEP, other, distances=FAR)).target == "jug"
