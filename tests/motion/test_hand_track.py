"""Status and reason of one hand."""

from __future__ import annotations

import pytest

from igrip.entities import Hand
from igrip.gating import GatingConfig
from igrip.motion.hand_track import HandTrack
from igrip.motion.trajectory import MotionConfig


def track():
    return HandTrack("right", MotionConfig(), GatingConfig())


def seen(track, now, x, **more):
    counted = track.update(now, Hand(position=(x, 0.0, 0.0), **more))
    track.advance(now)
    return counted


def test_warming_up_needs_three_samples():
    hand = track()
    for k, count in enumerate((1, 2)):
        assert seen(hand, k / 30, 0.0)
        assert hand.status == "warming_up"
        assert hand.reason(k / 30).startswith(f"{count} ")
        assert hand.motion is None
    seen(hand, 2 / 30, 0.001)
    assert (hand.status, hand.reason(2 / 30)) == ("idle", None)


def test_reaching_and_idle_go_by_speed():
    hand = track()
    for k in range(20):
        seen(hand, k / 30, 0.02 * k)
    assert hand.status == "reaching"
    for k in range(20, 60):
        seen(hand, k / 30, 0.4 + 1e-6 * k)
    assert hand.status == "idle"


def test_lost_and_found():
    hand = track()
    for k in range(6):
        seen(hand, k / 30, 0.001 * k)
    hand.advance(5 / 30 + 0.29)
    assert hand.status == "idle"
    hand.advance(5 / 30 + 0.31)
    assert hand.status == "lost"
    assert hand.reason(5 / 30 + 0.31) == "not measured for 0.31 s"
    seen(hand, 1.0, 0.5)
    assert hand.status == "warming_up"
    assert len(hand.trajectory) == 1
    assert hand.gate.counts["restarts"] == 1


def test_an_ignored_measurement_does_not_count_and_changes_nothing():
    hand = track()
    for k in range(6):
        seen(hand, 1.0 + k / 30, 0.001 * k)
    before = hand.motion
    assert not seen(hand, 1.2, 0.5, t=0.9)
    assert hand.motion is before
    assert hand.status == "idle"
    assert hand.gate.counts["older"] == 1


@pytest.mark.parametrize(
    ("x", "t", "word"),
    [(0.9, None, "jumped"), (0.006, 2.0, "future"), (500.0, None, "unit")],
)
def test_a_refused_measurement_makes_the_hand_invalid_until_the_next_good_one(x, t, word):
    hand = track()
    for k in range(6):
        seen(hand, 1.0 + k / 30, 0.001 * k)
    assert seen(hand, 1.0 + 6 / 30, x, t=t)
    assert hand.status == "invalid"
    assert word in hand.reason(1.2)
    seen(hand, 1.0 + 7 / 30, 0.007)
    assert (hand.status, hand.reason(1.0 + 7 / 30)) == ("idle", None)


def test_a_frozen_hand_is_named():
    hand = track()
    for k in range(30):
        seen(hand, k / 30, 0.25)
    assert "frozen" in hand.reason(29 / 30)
    seen(hand, 1.0, 0.25 + 1e-9)
    assert hand.reason(1.0) is None
