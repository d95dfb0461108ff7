"""When leases would have been given, from evidence written down by hand."""

import math

import pandas as pd
import pytest

from igrip.commitment import CommitmentConfig, Evidence
from igrip.lab.evaluation.commitments import (
    RELIABILITIES,
    Lease,
    MessageEvidence,
    at,
    configured_reliability,
    find_leases,
    first_commitments,
    summarise_commitments,
)

CONFIG = CommitmentConfig()
BOUNDS = (0.5, 1.5)
DEFAULT = RELIABILITIES.index(CONFIG.reliability)


def message(k, target="cup", hand="right", rejected=(), p=1.0):
    """Return the evidence at 50 Hz of a hand that moves to a target it is sure of, far from it."""
    evidence = Evidence(
        t=k / 50, measured=k / 50, position=(0.0, 0.0, 0.0), trusted=True, moving=True,
        target=target, grip="palmar", confidence={target: p},
        trusted_objects={target}, distances={target: 0.4},
    )  # fmt: skip
    return MessageEvidence({hand: evidence}, frozenset(rejected))


def idle(k, hand="right"):
    [(_, evidence)] = message(k).hands.items()
    still = evidence._replace(moving=False, target=None, confidence={})
    return MessageEvidence({hand: still}, frozenset())


def test_the_default_is_one_of_the_reliabilities():
    assert set(RELIABILITIES) >= {0.0, 0.1, 0.5, 1.0, CONFIG.reliability}
    assert list(RELIABILITIES) == sorted(RELIABILITIES)
    assert all(0.0 <= r <= 1.0 for r in RELIABILITIES)


def test_a_configured_reliability_is_evaluated_and_summed_up_on_its_own():
    """What tuning chose counts in the summary, not the library's default."""
    config = CONFIG.model_copy(update={"reliability": 0.83})
    messages = [message(k) for k in range(90)]
    row = first_commitments(messages, config, "right", "cup", BOUNDS)
    assert row["reliability"] == 0.83
    frame = pd.DataFrame([row | {"target": "cup"}])
    without = frame[:0].assign(seconds=[])
    curve = summarise_commitments(frame, without, configured_reliability(frame))
    own = at(0.83, curve)
    assert own is not None
    assert own["committed"] == 1.0
    [lease] = find_leases(messages, config)
    assert own["mean_part"] == pytest.approx(max(0.0, lease.t - BOUNDS[0]))
    assert at(CONFIG.reliability, curve) is None


def test_leases_begin_after_the_dwell_and_once_for_each_reach():
    messages = [message(k) for k in range(50)]
    [lease] = find_leases(messages, CONFIG)
    assert lease == Lease(pytest.approx(CONFIG.dwell, abs=0.021), "right", "cup")
    rest = [idle(k) for k in range(50, 100)]
    leases = find_leases([*messages, *rest, *(message(k, "can") for k in range(100, 150))], CONFIG)
    assert [lease.target for lease in leases] == ["cup", "can"]
    assert find_leases([idle(k) for k in range(50)], CONFIG) == []
    again = find_leases([*messages, *rest, *(message(k) for k in range(100, 150))], CONFIG)
    assert len(again) == 2  # another lease on the same target


def test_every_hand_has_leases_of_its_own():
    both = [
        MessageEvidence({**message(k).hands, **message(k, "can", "left").hands}, frozenset())
        for k in range(50)
    ]
    assert {(s.hand, s.target) for s in find_leases(both, CONFIG)} == {
        ("right", "cup"), ("left", "can"),
    }  # fmt: skip


def test_a_hand_without_a_lease_does_not_hide_another():
    both = [
        MessageEvidence({**idle(k, "left").hands, **message(k).hands}, frozenset())
        for k in range(50)
    ]
    assert [lease.hand for lease in find_leases(both, CONFIG)] == ["right"]


def test_nobody_is_there_to_confirm():
    asks = CONFIG.model_copy(update={"needs_confirmation": True})
    assert len(find_leases([message(k) for k in range(50)], asks)) == 1


def test_a_rejected_measurement_has_the_lease_earned_anew():
    """Rejected for one message in the middle of the dwell: it begins again there."""
    dwell = round(50 * CONFIG.dwell)
    assert dwell > 2
    messages = [message(k) for k in range(50)]
    [plain] = find_leases(messages, CONFIG)
    messages[dwell - 1] = MessageEvidence({}, frozenset({"right", "third"}))
    [late] = find_leases(messages, CONFIG)
    assert late.t - plain.t == pytest.approx(CONFIG.dwell, abs=0.021)
    messages[dwell - 1] = MessageEvidence({}, frozenset({"left"}))
    [other] = find_leases(messages, CONFIG)
    assert other.t == pytest.approx(plain.t, abs=0.021)


def first(messages, hand="right", target="cup", bounds=BOUNDS, config=CONFIG):
    return first_commitments(messages, config, hand, target, bounds)


def test_the_first_commitment_counts_by_its_part_of_the_movement():
    row = first([message(k) for k in range(50, 100)], bounds=(0.5, 2.5))
    assert row["commit_part"][DEFAULT] == pytest.approx(0.25 + CONFIG.dwell / 2, abs=0.011)
    assert row["commit_right"][DEFAULT] is True
    assert row["commit_part"][0] == pytest.approx(0.25)  # the most reactive does not wait
    known = [part for part in row["commit_part"] if part is not None]
    assert known == sorted(known)
    assert known[0] < known[-1]
    assert first([message(k, "can") for k in range(50, 100)])["commit_right"] == [False] * len(
        RELIABILITIES
    )


def test_a_lease_before_the_onset_counts_as_at_the_onset():
    assert first([message(k) for k in range(100)])["commit_part"][0] == 0.0


@pytest.mark.parametrize(("begin", "commits"), [(75, True), (76, False)])
def test_a_lease_after_the_end_of_the_movement_is_none(begin, commits):
    """The most reactive is given at once, at 1.5 s or at 1.52 s; the movement ends at 1.5 s."""
    row = first([message(k) for k in range(begin, 150)])
    assert row["commit_part"][0] == (1.0 if commits else None)
    assert row["commit_right"][0] is commits


def test_a_lease_of_another_hand_is_none():
    row = first([message(k, hand="left") for k in range(50, 100)])
    assert row["commit_part"] == [None] * len(RELIABILITIES)
    assert row["commit_right"] == [False] * len(RELIABILITIES)


def test_without_a_reach_leases_are_counted():
    row = first((message(k) for k in range(100)), None, "none", None)
    assert row == {"reliability": CONFIG.reliability, "commits": [1] * len(RELIABILITIES)}
    assert first([idle(k) for k in range(100)], None, "none", None)["commits"][0] == 0


def table(parts, right):
    """Return reaches, each with one part and one flag for every reliability."""
    n = len(RELIABILITIES)
    return pd.DataFrame(
        {"commit_part": [[p] * n for p in parts], "commit_right": [[r] * n for r in right]}
    )


def test_summary_by_hand():
    reaches = table([0.2, None, 0.6, 0.4], [True, False, False, True])
    none = pd.DataFrame(
        {"seconds": [60.0, 30.0], "commits": [[3] * len(RELIABILITIES), [0] * len(RELIABILITIES)]}
    )
    curve = summarise_commitments(reaches, none)
    assert [row["reliability"] for row in curve] == list(RELIABILITIES)
    assert curve[0] == {
        "reliability": 0.0, "reaches": 4, "committed": 0.75, "right": pytest.approx(2 / 3),
        "mean_part": pytest.approx((0.2 + 1.0 + 0.6 + 0.4) / 4), "false_per_minute": 2.0,
    }  # fmt: skip
    reaches["commit_part"] = [[0.2, *row[1:]] for row in reaches["commit_part"]]
    assert summarise_commitments(reaches, none)[0]["committed"] == 1.0
    assert summarise_commitments(reaches, none)[1]["committed"] == 0.75


def test_summary_of_what_is_there():
    empty = pd.DataFrame({"seconds": []})
    [*_, last] = summarise_commitments(table([None], [False]), empty)
    assert last == {
        "reliability": 1.0, "reaches": 1, "committed": 0.0, "right": None, "mean_part": 1.0,
    }  # fmt: skip
    assert summarise_commitments(pd.DataFrame({"seconds": []}), empty) == []
    none = pd.DataFrame({"seconds": [30.0, 30.0], "commits": [[1] * len(RELIABILITIES), math.nan]})
    assert summarise_commitments(empty, none)[0] == {"reliability": 0.0, "false_per_minute": 1.0}
    some = pd.concat([table([0.5], [True]), pd.DataFrame({"commit_part": [None]})])
    assert summarise_commitments(some, empty)[0]["reaches"] == 1
