"""The gate exactly at its limits, with numbers that binary floats hold exactly; and pairs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.gating import MIN_STEP, Gate, GatingConfig, find_coincident

HERE = (0.25, 0.5, 0.75)
EXACT = GatingConfig(
    future_tolerance=0.0625, restart_after=0.25, jump_distance=0.125, jump_speed=4.0,
    frozen_after=0.5, max_range=64.0,
)  # fmt: skip


def gate(max_age=0.5):
    return Gate(EXACT, max_age)


def after(*times, max_age=0.5, x=0.25):
    """Return a gate that has accepted one place at some times."""
    g = gate(max_age)
    for t in times:
        assert g.check(t, t, (x, 0.5, 0.75)).action in ("accept", "restart")
    return g


@pytest.mark.parametrize(("t", "action"), [(1.0625, "accept"), (1.0626, "reject")])
def test_the_tolerance_of_the_future_is_allowed(t, action):
    verdict = gate().check(1.0, t, HERE)
    assert verdict.action == action
    if action == "reject":
        assert verdict.reason == "measured 0.0626 s in the future of its arrival"


@pytest.mark.parametrize(("x", "action"), [(64.0, "accept"), (-64.0, "accept"), (64.1, "reject")])
def test_the_range_itself_is_allowed(x, action):
    assert gate().check(1.0, 1.0, (0.0, 0.0, x)).action == action


@pytest.mark.parametrize(("dt", "action"), [(0.5, "accept"), (0.5625, "restart")])
def test_a_gap_may_be_as_long_as_the_age_limit(dt, action):
    g = after(1.0)
    assert g.check(1.0 + dt, 1.0 + dt, HERE).action == action
    assert g.counts["restarts"] == (action == "restart")


@pytest.mark.parametrize(("now", "stale"), [(1.5, False), (1.5625, True)])
def test_a_measurement_is_fresh_up_to_the_age_limit(now, stale):
    assert after(1.0).is_stale(now) == stale


@pytest.mark.parametrize(("dt", "action"), [(2 * MIN_STEP, "accept"), (0.5 * MIN_STEP, "ignore")])
def test_measurements_must_be_apart_in_time(dt, action):
    assert after(0.0).check(dt, dt, HERE).action == action


@pytest.mark.parametrize(("step", "action"), [(0.375, "accept"), (0.376, "reject")])
def test_a_step_may_be_as_long_as_the_bound(step, action):
    g = after(1.0, x=0.0)
    assert g.check(1.0625, 1.0625, (step, 0.5, 0.75)).action == action  # 0.125 m + 4 m/s · 1/16 s


@pytest.mark.parametrize(("last", "frozen"), [(1.5, True), (1.4375, False)])
def test_a_position_is_frozen_after_the_full_time(last, frozen):
    g = after(*np.arange(1.0, last + 0.01, 0.0625))
    assert (g.warning is not None) == frozen
    if frozen:
        assert g.warning == "frozen: the same position to the last bit for 0.50 s"


def test_a_restart_begins_the_time_of_a_frozen_position_anew():
    g = after(1.0, 1.25, 2.0, 2.25)
    assert g.counts["restarts"] == 1
    assert g.warning is None
    assert g.check(2.5, 2.5, HERE).action == "accept"
    assert g.warning is not None


@pytest.mark.parametrize(("wait", "action"), [(0.25, "restart"), (0.1875, "reject")])
def test_a_stream_that_stays_rejected_restarts_after_the_full_time(wait, action):
    g = after(1.0)
    assert g.check(1.0625, 1.0625, (9.0, 0.5, 0.75)).action == "reject"
    now = 1.0625 + wait
    assert g.check(now, now, (9.0, 0.5, 0.75)).action == action


def test_rejected_times_that_fall_are_no_stream():
    """A queue that is read backwards: its times differ, but do not grow."""
    g = after(2.0)
    for k in range(20):
        t = 1.5 - 0.03125 * k
        assert g.check(2.0 + 0.03125 * k, t, HERE).action == "ignore"


@pytest.mark.parametrize("before", [(), (1.5,)])
def test_the_first_rejected_measurement_begins_the_wait(before):
    """Also after others were accepted in between: only an unbroken series is a new stream."""
    g = after(1.0)
    for t in before:
        assert g.check(t - 0.125, t - 0.5625, HERE).action == "ignore"
        assert g.check(t, t, HERE).action == "accept"
    start = 1.0 if not before else 1.5
    assert g.check(start + 0.0625, start - 0.0625, HERE).action == "ignore"
    assert g.check(start + 0.3125, start - 0.03125, HERE).action == "restart"


def stepped_back():
    """Return a gate whose entity's clock is 4 s behind since 10 s."""
    g = after(10.0)
    assert g.check(10.0625, 6.0625, HERE).action == "ignore"
    assert g.check(10.3125, 6.3125, HERE).action == "restart"
    assert g.offset == 4.0
    assert g.newest == 10.3125
    return g


@pytest.mark.parametrize(
    ("now", "t", "action", "offset"),
    [
        (11.0, 7.0625, "accept", 4.0),  # with its offset still within the tolerance
        (11.0, 7.125, "restart", 3.875),  # with it in the future: its clock stepped
        (11.0, 11.0625, "restart", 0.0),  # right again, within the tolerance
        (11.0, 11.125, "reject", 4.0),  # in the future even without an offset
    ],
)
def test_a_clock_that_steps_forward_again(now, t, action, offset):
    g = stepped_back()
    g.check(10.75, 6.75, HERE)
    assert g.check(now, t, HERE).action == action
    assert g.offset == offset


@pytest.mark.parametrize(("age", "offset"), [(0.5, 0.0), (0.5625, 0.5625)])
def test_a_clock_within_the_age_limit_needs_no_offset(age, offset):
    g = after(10.0)
    assert g.check(10.25, 10.25 - age - 0.03125, HERE).action == "ignore"
    assert g.check(10.5, 10.5 - age, HERE).action == "restart"
    assert g.offset == offset


def brute_force(positions, separation):
    """Return every entity that has another near it."""
    return {
        a
        for a, p in positions.items()
        for b, q in positions.items()
        if a != b and math.dist(p, q) < separation
    }


@given(st.integers(0, 10_000), st.integers(0, 12), st.floats(0.01, 1.0))
def test_coincident_entities_are_those_of_brute_force(seed, count, separation):
    rng = np.random.default_rng(seed)
    positions = {f"e{k}": tuple(rng.uniform(-1.0, 1.0, 3)) for k in range(count)}
    found = find_coincident(positions, separation)
    assert found.keys() == brute_force(positions, separation)
    for a, b in found.items():
        assert math.dist(positions[a], positions[b]) < separation


def test_the_separation_itself_is_apart():
    pair = {"a": (0.0, 0.0, 0.0), "b": (0.0, 0.25, 0.0)}
    assert find_coincident(pair, 0.25) == {}
    assert find_coincident(pair, 0.26) == {"a": "b", "b": "a"}


def test_only_near_entities_are_compared(monkeypatch):
    """A row of entities takes as many comparisons as it has neighbours, not pairs."""
    calls = []
    distance = math.dist
    monkeypatch.setattr("igrip.gating.math.dist", lambda p, q: calls.append(1) or distance(p, q))
    find_coincident({f"e{k:03}": (0.1 * k, 0.0, 0.0) for k in range(100)}, 0.05)
    assert not calls
    find_coincident({f"e{k:03}": (0.1 * k, 0.0, 0.0) for k in range(100)}, 0.15)
    assert len(calls) == 99
