"""Times of recordings put in order, against the times that they should have had."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip import Observation
from igrip.io.timeline import order_times

T = [k / 30.0 for k in range(60)]


def ordered(times):
    defects = []
    messages = [
        (f"line {k}", Observation(t=t, hands={"right": {"position": [k, 0, 0], "t": t}}))
        for k, t in enumerate(times, 1)
    ]
    kept = list(order_times(messages, lambda defect, place: defects.append((defect, place))))
    return [m.t for _, m in kept], [m.hands["right"] for _, m in kept], defects


def test_good_times_are_left_as_they_are():
    times = sorted([*T, *T[:5]])  # equal times too
    assert ordered(times)[0] == times
    assert ordered(times)[2] == []


@pytest.mark.parametrize("step", [-0.1, -0.4, -1.0, -20.0])
@pytest.mark.parametrize("at", [10, 20, 50])
def test_a_step_back_for_good_loses_nothing(step, at):
    shifted = [100.0 + t + (step if k >= at else 0.0) for k, t in enumerate(T)]
    times, hands, defects = ordered(shifted)
    assert len(times) >= len(T) - 3
    if len(times) == len(T):
        assert times == pytest.approx([100.0 + t for t in T], abs=1e-6)
        assert [hand.t for hand in hands] == pytest.approx(times)
    assert {place for _, place in defects} <= {f"line {at + 1 + k}" for k in range(3)}
    assert defects


@pytest.mark.parametrize("off", [-20.0, -0.5, 5.0, 1e6])
@pytest.mark.parametrize("at", [0, 1, 20, 59])
def test_one_odd_time_costs_one_message(off, at):
    odd = [100.0 + t + (off if k == at else 0.0) for k, t in enumerate(T)]
    times, _, defects = ordered(odd)
    assert times == sorted(times)
    expected = [t for k, t in enumerate(odd) if k != at]
    if at not in (0, 59):  # at an end nothing shows which is right
        assert times == expected
        assert [place for _, place in defects] == [f"line {at + 1}"]
    assert len(times) >= len(T) - 1


def test_a_gap_is_named_and_kept():
    times, _, defects = ordered([*T[:20], *(20.0 + t for t in T[20:])])
    assert len(times) == len(T)
    [(defect, place)] = defects
    assert (defect.kind, place) == ("gap", "line 21")


@given(st.lists(st.floats(0.0, 1e7), max_size=40))
def test_whatever_comes_never_goes_back(times):
    kept, _, _ = ordered(times)
    assert kept == sorted(kept)
