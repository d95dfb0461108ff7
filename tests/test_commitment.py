"""The lease of one hand, step by step."""

from __future__ import annotations

import pytest

from igrip.commitment import CommitmentConfig, Committer, Evidence

SURE = {"cup": 0.95, "jug": 0.03}
PLAIN = CommitmentConfig(reliability=0.5)


def evidence(t, confidence=None, **changed):
    """Return evidence for a hand that moves and is sure of the cup."""
    confidence = SURE if confidence is None else confidence
    best = max(confidence, key=confidence.get) if confidence else None
    fields = {
        "t": t, "measured": t, "position": (0.0, 0.0, 0.0), "trusted": True, "moving": True,
        "target": best, "grip": "palmar", "confidence": confidence,
        "trusted_objects": set(confidence), "distances": {"cup": 0.3, "jug": 0.5},
    }  # fmt: skip
    return Evidence(**(fields | changed))


def committed(committer, t=0.0):
    """Bring a committer to its commitment; return the time of the newest message."""
    for _ in range(20):
        t += 1.0 / 30.0
        if committer.update(evidence(t)) is not None:
            return t
    raise AssertionError("it never committed")


def holding(committer):
    t = committed(committer) + 1.0 / 30.0
    lease = committer.update(evidence(t, moving=False, distances={"cup": 0.04, "jug": 0.4}))
    assert committer.state == "holding"
    assert lease is not None
    return t


def test_a_lease_is_earned_by_the_dwell_and_ends_after_the_newest_measurement():
    committer = Committer(PLAIN)
    times = [k / 100.0 for k in range(1, 40)]
    leases = [committer.update(evidence(t, measured=t - 0.02)) for t in times]
    first = next(k for k, lease in enumerate(leases) if lease)
    assert times[first] - times[0] == pytest.approx(PLAIN.dwell, abs=0.011)
    lease = leases[-1]
    assert (lease.target, lease.grip, lease.since) == ("cup", "palmar", times[first])
    assert lease.valid_until == pytest.approx(times[-1] - 0.02 + 0.15)


def test_the_reactive_commits_at_once_and_the_reliable_asks_for_more():
    reactive, reliable = (Committer(CommitmentConfig(reliability=r)) for r in (0.0, 1.0))
    likely = {"cup": 0.6, "jug": 0.2}
    assert reactive.update(evidence(0.1, likely)) is not None
    for k in range(30):
        assert reliable.update(evidence(0.1 + k / 30.0, SURE)) is None
    surer = {"cup": 0.99, "jug": 0.0}
    assert any(reliable.update(evidence(2.0 + k / 30.0, surer)) for k in range(10))


def test_another_target_begins_its_dwell_anew():
    committer = Committer(PLAIN)
    assert committer.update(evidence(0.00)) is None
    assert committer.update(evidence(0.08, {"cup": 0.02, "jug": 0.96})) is None
    assert committer.update(evidence(0.12)) is None
    assert (committer.state, committer.target) == ("earning", "cup")


def test_hysteresis_keeps_what_is_somewhat_less_likely():
    committer = Committer(PLAIN)
    t = committed(committer)
    kept = {"cup": PLAIN.threshold - PLAIN.hysteresis + 0.01, "jug": 0.2}
    assert committer.update(evidence(t + 0.03, kept)).target == "cup"
    less = {"cup": PLAIN.threshold - PLAIN.hysteresis - 0.01, "jug": 0.3}
    assert committer.update(evidence(t + 0.06, less)) is None
    assert committer.state == "open"


def test_only_a_moving_hand_earns_a_lease():
    committer = Committer(PLAIN)
    for k in range(60):
        assert committer.update(evidence(k / 30.0, moving=False)) is None


def test_doubtful_input_pauses_and_a_short_pause_costs_no_dwell():
    committer = Committer(PLAIN)
    t = committed(committer)
    assert committer.update(evidence(t + 0.05, trusted=False)) is None
    assert committer.update(evidence(t + 0.25)) is not None
    assert committer.update(evidence(t + 0.60)) is None  # now it is earned anew
    assert committer.state == "earning"


@pytest.mark.parametrize("late", [0.15, 0.4])
def test_an_old_measurement_gives_no_lease(late):
    committer = Committer(PLAIN)
    t = committed(committer)
    assert committer.update(evidence(t + 0.1, measured=t + 0.1 - late)) is None


def test_a_target_that_is_not_seen_pauses_the_lease():
    committer = Committer(PLAIN)
    t = committed(committer)
    assert committer.update(evidence(t + 0.03, trusted_objects={"jug"})) is None
    assert committer.state == "committed"
    assert committer.update(evidence(t + 0.06)) is not None


def test_a_hand_that_stops_at_its_target_holds_it_and_takes_no_other():
    committer = Committer(PLAIN)
    t = holding(committer)
    other = {"cup": 0.01, "jug": 0.98}
    for k in range(1, 30):
        near = {"cup": 0.05, "jug": 0.02}
        lease = committer.update(evidence(t + k / 30.0, other, distances=near))
        assert lease.target == "cup"
    far = {"cup": 0.25, "jug": 0.02}
    assert committer.update(evidence(t + 1.1, other, distances=far)) is None
    assert committer.state != "holding"


def test_a_hand_that_stops_elsewhere_is_open_again():
    committer = Committer(PLAIN)
    t = committed(committer)
    assert committer.update(evidence(t + 0.03, moving=False)) is None
    assert committer.state == "open"


def test_what_is_hidden_in_the_hand_is_not_taken_for_left():
    committer = Committer(PLAIN)
    t = holding(committer)
    away = {"position": (0.3, 0.0, 0.0), "trusted_objects": set()}
    assert committer.update(evidence(t + 0.1, distances={"cup": 0.3}, **away)) is None
    assert committer.state == "holding"
    committer.update(
        evidence(t + 2.5, distances={}, **away)
    )  # it is given up, and the hand elsewhere
    assert committer.state == "open"


def test_a_long_pause_while_holding_ends_the_lease_for_good():
    committer = Committer(PLAIN)
    t = holding(committer)
    near = {"cup": 0.04}
    assert committer.update(evidence(t + 0.2, moving=False, distances=near)) is not None
    assert committer.update(evidence(t + 0.9, moving=False, distances=near)) is None
    assert committer.update(evidence(t + 1.0, moving=False, distances=near)) is None
    assert committer.state == "holding"


def test_the_device_says_that_it_has_opened():
    committer = Committer(PLAIN)
    t = holding(committer)
    committer.notify_released()
    assert committer.state == "open"
    assert committer.update(evidence(t + 0.03, moving=False, distances={"cup": 0.04})) is None


def test_a_veto_ends_it_until_the_hand_has_rested():
    committer = Committer(PLAIN)
    t = committed(committer)
    committer.veto()
    for k in range(1, 30):
        assert committer.update(evidence(t + k / 30.0)) is None
    committer.update(evidence(t + 1.1, moving=False))
    assert committer.update(evidence(t + 1.15)) is None  # a moment is no rest
    for k in range(11):
        committer.update(evidence(t + 1.2 + k / 30.0, moving=False))
    assert committed(committer, t + 1.6)


def test_a_veto_outlives_a_dropout_and_rest_that_is_not_believed():
    committer = Committer(PLAIN)
    t = committed(committer)
    committer.veto()
    for k in range(30):  # frozen, say
        committer.update(evidence(t + k / 30.0, moving=False, trusted=False))
    for k in range(6):  # seen anew: it seems to rest at first
        committer.update(evidence(t + 2.0 + k / 30.0, moving=False))
    for k in range(60):
        assert committer.update(evidence(t + 2.2 + k / 30.0)) is None


def test_each_reach_is_confirmed_anew():
    committer = Committer(CommitmentConfig(needs_confirmation=True))
    committer.update(evidence(0.0))
    committer.confirm()
    t = committed(committer)
    committer.update(evidence(t + 0.03, moving=False, distances={"cup": 0.04, "jug": 0.4}))
    assert committer.state == "holding"
    other = {"cup": 0.01, "jug": 0.98}
    for k in range(60):
        gaps = {"cup": 0.4, "jug": 0.1}
        assert committer.update(evidence(t + 0.06 + k / 30.0, other, distances=gaps)) is None


def test_a_confirmation_spares_the_dwell_and_can_be_asked_for():
    committer = Committer(PLAIN)
    committer.confirm()
    assert committer.update(evidence(0.1)) is not None
    asking = Committer(CommitmentConfig(needs_confirmation=True))
    for k in range(30):
        assert asking.update(evidence(k / 30.0)) is None
    asking.confirm()
    assert asking.update(evidence(1.03)) is not None


def test_which_hands_are_assisted():
    assert CommitmentConfig().assists("left")
    config = CommitmentConfig(assisted=("right",))
    assert config.assists("right")
    assert not config.assists("left")
    assert not CommitmentConfig(assisted=()).assists("left")


@pytest.mark.parametrize(
    ("familiarity", "threshold"),
    [(None, 0.7), (1.0, 0.7), (0.3, 0.7), (0.15, 0.8), (0.0, 0.9)],
)
def test_a_strange_movement_needs_a_higher_confidence(familiarity, threshold):
    config = CommitmentConfig(
        reliability=0.0, min_threshold=0.7, strange_margin=0.2, full_familiarity=0.3
    )
    assert config.threshold_in(familiarity) == pytest.approx(threshold)
    for confidence, leased in ((threshold + 0.01, True), (threshold - 0.01, False)):
        one = evidence(0.1, {"cup": confidence, "jug": 0.0}, familiarity=familiarity)
        assert (Committer(config).update(one) is not None) == leased


def test_no_threshold_is_raised_beyond_reach_nor_lowered():
    high = CommitmentConfig(reliability=1.0, max_threshold=0.95, strange_margin=0.2)
    assert high.threshold_in(0.0) == 0.98
    beyond = CommitmentConfig(reliability=1.0, max_threshold=0.995, strange_margin=0.2)
    assert beyond.threshold_in(0.0) == beyond.threshold_in(1.0) == pytest.approx(0.995)


def test_a_movement_that_turns_strange_loses_its_lease():
    config = CommitmentConfig(reliability=0.0, min_threshold=0.6, hysteresis=0.1)
    committer, likely = Committer(config), {"cup": 0.62, "jug": 0.1}
    assert committer.update(evidence(0.1, likely, familiarity=0.5)) is not None
    assert committer.update(evidence(0.13, likely, familiarity=0.2)) is not None
    assert committer.update(evidence(0.16, likely, familiarity=0.0)) is None


def approach(committer, begin, end, **changed):
    """Return the leases of a hand that is sure of the cup, 30 times a second."""
    times = [begin + k / 30.0 for k in range(round((end - begin) * 30.0))]
    return [committer.update(evidence(t, **changed)) for t in times]


HELD = {"held": {"cup": "left"}}
AT_IT = {"distances": {"cup": 0.05, "jug": 0.5}}


def test_what_another_hand_holds_gets_no_lease_and_the_reason_says_who():
    committer = Committer(PLAIN)
    assert not any(approach(committer, 0.0, 1.0, **HELD))
    assert committer.refused_because == "cup is held by left"
    assert committer.update(evidence(1.1)) is None  # free again: the dwell begins
    assert any(approach(committer, 1.2, 1.6))
    assert committer.refused_because is None


def test_another_object_than_the_held_one_may_be_committed_to():
    committer = Committer(PLAIN)
    assert any(approach(committer, 0.0, 1.0, held={"jug": "left"}))


def test_a_lease_ends_when_another_hand_takes_the_object():
    committer = Committer(PLAIN)
    t = committed(committer)
    assert committer.update(evidence(t + 0.03, **HELD)) is None
    holder = Committer(PLAIN)
    t = holding(holder)
    gone = evidence(t + 0.03, moving=False, **HELD, **AT_IT)
    assert holder.update(gone) is None


def test_the_refused_lease_begins_when_the_object_is_free_and_the_hand_at_it():
    committer = Committer(PLAIN)
    assert not any(approach(committer, 0.0, 1.0, **HELD))
    waits = {"confidence": {"cup": 0.4, "jug": 0.1}, "moving": False, **AT_IT}
    assert not any(approach(committer, 1.0, 1.5, **HELD, **waits))
    lease = committer.update(evidence(1.5, **waits))
    assert lease is not None
    assert (lease.target, lease.since) == ("cup", 1.5)
    assert committer.state == "holding"
    # it takes the object away
    away = evidence(1.55, carried=["cup"], **AT_IT)
    assert committer.update(away) is not None


@pytest.mark.parametrize(
    "changed",
    [
        {"distances": {"cup": 0.3, "jug": 0.5}},  # not at it
        {"moving": True, "target": "jug"},  # on its way to something else
        {"carried": ["jug"], "distances": {"cup": 0.05, "jug": 0.05}},  # its hand is full
        {"trusted_objects": {"jug"}},  # nobody sees it
    ],
)
def test_the_refused_lease_does_not_begin_otherwise(changed):
    committer = Committer(PLAIN)
    approach(committer, 0.0, 1.0, **HELD, **AT_IT)
    unsure = {"confidence": {"cup": 0.4, "jug": 0.1}, "moving": False, **AT_IT}
    assert committer.update(evidence(1.0, **(unsure | changed))) is None


def test_who_waits_too_long_or_vetoes_gets_nothing():
    rest = {"confidence": {"cup": 0.4, "jug": 0.1}, "moving": False, **AT_IT}
    patient = Committer(PLAIN)
    approach(patient, 0.0, 1.0, **HELD)
    approach(patient, 1.0, 1.0 + PLAIN.max_wait + 0.1, **HELD, **rest)
    assert patient.update(evidence(1.1 + PLAIN.max_wait, **rest)) is None
    vetoed = Committer(PLAIN)
    approach(vetoed, 0.0, 1.0, **HELD)
    vetoed.veto()
    assert vetoed.update(evidence(1.1, **rest)) is None


def test_a_refused_lease_must_be_confirmed_where_every_lease_must():
    rest = {"confidence": {"cup": 0.4, "jug": 0.1}, "moving": False, **AT_IT}
    committer = Committer(CommitmentConfig(reliability=0.5, needs_confirmation=True))
    approach(committer, 0.0, 1.0, **HELD)
    assert committer.update(evidence(1.05, **rest)) is None
    committer.confirm()
    assert committer.update(evidence(1.1, **rest)) is not None
