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


EXACT = GatingConfig(max_hand_age=0.25, frozen_after=0.5)  # numbers that binary floats hold exactly
STEP = 0.0625


def followed(samples=6, dx=0.001):
    """Return a track of a hand that was measured until 1 s."""
    hand = HandTrack("right", MotionConfig(), EXACT)
    for k in range(samples):
        seen(hand, 1.0 - STEP * (samples - 1 - k), dx * k)
    return hand


def test_a_hand_that_is_followed_is_trusted():
    hand = followed()
    assert hand.status == "idle"
    assert hand.is_followed
    assert hand.trusted
    assert not hand.is_stale


@pytest.mark.parametrize(
    ("change", "status"),
    [
        (lambda: followed(samples=2), "warming_up"),
        (lambda: seen_after(followed(), 0.9), "invalid"),
        (lambda: advanced(followed(), 1.3125), "lost"),
    ],
)
def test_a_hand_with_another_status_is_neither_followed_nor_trusted(change, status):
    hand = change()
    assert hand.status == status
    assert not hand.is_followed
    assert not hand.trusted


def seen_after(hand, x, now=1.0 + STEP):
    seen(hand, now, x)
    return hand


def advanced(hand, now):
    hand.advance(now)
    return hand


def test_a_frozen_hand_and_one_at_the_place_of_another_are_followed_but_not_trusted():
    frozen = followed(samples=10, dx=0.0)
    assert "frozen" in frozen.reason(1.0)
    doubled = followed()
    doubled.same_as = "left"
    assert doubled.reason(1.0) == "contradictory: is where hand left is"
    for hand in (frozen, doubled):
        assert hand.is_followed
        assert not hand.trusted


def test_a_hand_is_steady_again_once_nothing_was_rejected_for_the_age_limit():
    hand = followed()
    assert hand.is_steady(1.0)
    seen(hand, 1.0 + STEP, 0.9)  # it jumps
    for k in range(2, 6):
        seen(hand, 1.0 + k * STEP, 0.006)
    assert not hand.is_steady(1.0 + 5 * STEP)  # just the limit of 0.25 s later
    seen(hand, 1.0 + 6 * STEP, 0.007)
    assert hand.is_steady(1.0 + 6 * STEP)
    assert not advanced(hand, 2.0).is_steady(2.0)  # it is no longer measured
    assert hand.is_stale


def test_a_hand_that_was_never_accepted_is_not_steady():
    hand = HandTrack("right", MotionConfig(), EXACT)
    seen(hand, 1.0, 500.0)
    assert not hand.is_steady(1.0)
    assert not hand.is_steady(9.0)
    assert hand.status == "invalid"
    hand.advance(9.0)
    assert hand.reason(9.0) == "no trusted measurement yet"


def test_a_rejection_is_named_for_the_age_limit_and_then_the_loss():
    hand = seen_after(followed(), 0.9)
    hand.advance(1.0 + 5 * STEP)
    assert "jumped" in hand.reason(1.0 + 5 * STEP)
    hand.advance(1.0 + 6 * STEP)
    assert hand.status == "lost"
