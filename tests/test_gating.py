"""The gate: which measurements of one entity are believed, rule by rule."""

from __future__ import annotations

import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

import igrip
from igrip.gating import Gate, GatingConfig, find_coincident
from support import BOX, UPRIGHT

HERE = (0.1, 0.2, 0.3)


def gate(limit=0.3, **config):
    return Gate(GatingConfig(**config), limit)


def moved(dx):
    return (HERE[0] + dx, HERE[1], HERE[2])


def steady(gate, start, end, rate=30.0, dx=0.001):
    """Feed a stream that is in order; return the verdicts."""
    count = round((end - start) * rate)
    return [gate.check(start + k / rate, start + k / rate, moved(k * dx)) for k in range(count)]


def test_a_stream_in_order_is_accepted():
    g = gate()
    assert {v.action for v in steady(g, 1.0, 2.0)} == {"accept"}
    assert g.counts == {}
    assert g.newest == pytest.approx(2.0 - 1 / 30)


def test_the_first_measurement_is_late_before_and_not_after():
    g = gate()
    assert math.isnan(g.newest)
    assert g.is_stale(0.0)
    g.check(5.0, 5.0, HERE)
    assert not g.is_stale(5.0)
    assert not g.is_stale(5.299)
    assert g.is_stale(5.301)


@pytest.mark.parametrize(
    ("t", "action"), [(1.0, "accept"), (1.049, "accept"), (1.051, "reject"), (9.0, "reject")]
)
def test_future(t, action):
    g = gate()
    verdict = g.check(1.0, t, HERE)
    assert verdict.action == action
    assert g.counts["future"] == (action == "reject")
    assert ("future" in (verdict.reason or "")) == (action == "reject")


@pytest.mark.parametrize("value", [100.1, -1e4, 1e300, -1e308])
def test_far(value):
    g = gate()
    verdict = g.check(1.0, 1.0, (0.0, value, 0.0))
    assert verdict.action == "reject"
    assert "is its unit the metre?" in verdict.reason
    assert g.counts["far"] == 1
    assert math.isnan(g.newest)
    assert g.check(1.1, 1.1, HERE).action == "accept"


@pytest.mark.parametrize("back", [0.0, 0.01, 0.5])
def test_older_or_equal_is_ignored_and_counted(back):
    g = gate()
    steady(g, 1.0, 2.0)
    newest = g.newest
    assert g.check(2.0, newest - back, moved(0.9)).action == "ignore"
    assert g.counts["older"] == 1
    assert g.newest == newest
    assert g.check(2.0, 2.0, moved(0.031)).action == "accept"


@pytest.mark.parametrize("step", [0.5, 1.0, 30.0])
def test_a_stepped_clock_heals_after_a_while(step):
    """Its age can then no longer be known: it counts from the restart."""
    g = gate()
    steady(g, 50.0, 51.0)
    times = [51.0 + k / 30 for k in range(20)]
    actions = [g.check(t, t - step, moved(0.03)).action for t in times]
    first = actions.index("restart")
    assert first in (9, 10)  # 0.3 s, as the clock rounds
    assert actions == ["ignore"] * first + ["restart"] + ["accept"] * (19 - first)
    assert g.newest == pytest.approx(times[-1])
    assert g.offset == pytest.approx(step)
    assert not g.is_stale(times[-1])
    assert "clock" in g.warning


def test_a_clock_that_steps_forward_again_is_believed_again():
    g = gate()
    steady(g, 50.0, 51.0)
    for k in range(20):
        g.check(51.0 + k / 30, 41.0 + k / 30, moved(0.03))
    assert g.offset == pytest.approx(10.0)
    assert g.check(51.7, 51.69, moved(0.03)).action == "restart"
    assert g.offset == 0.0
    assert g.newest == 51.69
    assert g.check(51.73, 51.72, moved(0.03)).action == "accept"


@pytest.mark.parametrize("value", [1e300, 101.0])
def test_a_clock_that_is_right_again_does_not_excuse_the_rest(value):
    g = gate()
    steady(g, 50.0, 51.0)
    for k in range(20):
        g.check(51.0 + k / 30, 41.0 + k / 30, moved(0.03))
    assert g.check(51.7, 51.69, (value, 0.0, 0.0)).action == "reject"
    assert g.counts["far"] == 1


def test_a_pose_that_is_sent_again_with_its_old_time_is_no_stream():
    g = gate()
    steady(g, 1.0, 2.0)
    newest = g.newest
    actions = {g.check(2.0 + k / 30, newest, moved(0.029)).action for k in range(60)}
    assert actions == {"ignore"}
    assert g.newest == newest
    assert g.counts == {"older": 60}


def test_one_old_measurement_now_and_then_does_not_add_up():
    g = gate()
    for k in range(60):
        t = 1.0 + k / 30
        assert g.check(t, t, moved(0.001 * k)).action == "accept"
        if k % 2:
            assert g.check(t, t - 0.01, moved(0.0)).action == "ignore"
    assert g.counts["restarts"] == 0


@pytest.mark.parametrize(
    ("step", "dt", "action"),
    [
        (0.25, 1 / 30, "accept"),  # 0.1 m + 5 m/s · dt allow 0.267 m
        (0.28, 1 / 30, "reject"),
        (1.0, 1 / 30, "reject"),
        (0.55, 0.1, "accept"),
        (0.65, 0.1, "reject"),
    ],
)
def test_jump(step, dt, action):
    g = gate()
    g.check(1.0, 1.0, HERE)
    verdict = g.check(1.0 + dt, 1.0 + dt, moved(step))
    assert verdict.action == action
    if action == "reject":
        assert verdict.reason == f"jumped {step:.2f} m in {dt:.3f} s"
        assert g.counts["jump"] == 1


def test_a_single_jump_is_forgotten():
    g = gate()
    steady(g, 1.0, 1.5)
    assert g.check(1.5, 1.5, moved(1.0)).action == "reject"
    assert g.check(1.53, 1.53, moved(0.015)).action == "accept"
    assert g.counts == {"jump": 1}


@pytest.mark.parametrize("distance", [1.0, 1.5, 3.0])
def test_a_jump_that_stays_starts_the_stream_anew_after_a_while(distance):
    """Never by way of ``accept``: a teleport is no movement of several metres per second."""
    g = gate()
    steady(g, 1.0, 1.5)
    verdicts = [g.check(1.5 + k / 30, 1.5 + k / 30, moved(distance)) for k in range(12)]
    actions = [verdict.action for verdict in verdicts]
    first = next(k for k, action in enumerate(actions) if action != "reject")
    assert actions[first] == "restart"
    assert 8 <= first <= 10  # 0.3 s
    assert set(actions[first + 1 :]) == {"accept"}


def test_a_gap_longer_than_the_limit_starts_anew():
    g = gate(limit=0.3)
    steady(g, 1.0, 1.5)
    assert g.check(1.75, 1.75, moved(0.1)).action == "accept"
    assert g.check(2.1, 2.1, moved(0.1)).action == "restart"
    assert g.counts["restarts"] == 1


def test_frozen():
    g = gate()
    for k in range(14):
        g.check(1.0 + k / 30, 1.0 + k / 30, HERE)
    assert g.warning is None
    for k in range(14, 20):
        g.check(1.0 + k / 30, 1.0 + k / 30, HERE)
    assert g.warning.startswith("frozen")
    g.check(2.0, 2.0, moved(1e-15))
    assert g.warning is None


def test_nothing_is_frozen_before_it_was_seen():
    assert gate().warning is None


@given(
    st.lists(
        st.tuples(st.floats(0.0, 0.5), st.floats(-1.0, 0.2), st.floats(-2e2, 2e2)), max_size=40
    )
)
def test_newest_never_runs_ahead_and_only_a_restart_goes_back(rows):
    g, now = gate(), 1.0
    for wait, offset, x in rows:
        now += wait
        before = g.newest
        verdict = g.check(now, max(0.0, now + offset), (x, 0.0, 0.0))
        if verdict.action in ("ignore", "reject"):
            assert g.newest == before or math.isnan(before)
            assert verdict.reason
        else:
            assert verdict.reason is None
            assert g.newest <= now + 0.05
            if verdict.action == "accept" and not math.isnan(before):
                assert g.newest > before
        assert g.counts["restarts"] <= len(rows)


def disturb(rng, g, now):
    """Feed clocks that step, jumps, pauses and absurd places; return the time afterwards."""
    offset = x = 0.0
    for _ in range(100):
        now += rng.choice((0.033, 0.033, 0.033, 0.0, 0.1, 0.5))
        if rng.random() < 0.05:
            offset = rng.choice((0.0, -0.2, -0.5, -5.0, -100.0, 0.03, 0.2, 3.0))
        if rng.random() < 0.05:
            x += rng.choice((0.2, 0.5, 1.0, 5.0, 200.0, -0.4, -1.0, -200.0))
        t = max(0.0, now + offset - rng.uniform(0.0, 0.04))
        verdict = g.check(now, t, (x + rng.gauss(0.0, 0.003), 0.0, 0.0))
        if verdict.action in ("accept", "restart"):
            assert g.newest <= now + 0.05 + 1e-9
            assert abs(x) < 101.0
    return now


def test_whatever_came_before_a_healthy_stream_is_believed_within_a_second():
    for seed in range(300):
        rng = random.Random(seed)
        g = gate(limit=rng.choice((0.3, 2.0)))
        now = disturb(rng, g, 200.0)
        for k in range(45):
            now += 1 / 30
            verdict = g.check(now, now - 0.02, moved(0.001 * k))
            assert verdict.action in ("accept", "restart") or k < 32
        assert not g.is_stale(now)


@pytest.mark.parametrize(("back", "then"), [(1.0, 0.5), (100.0, 7.0)])
def test_a_clock_that_steps_back_and_partly_forward_again_heals_too(back, then):
    g = gate()
    steady(g, 200.0, 201.0)
    actions = []
    for k in range(120):
        now = 201.0 + k / 30
        actions.append(g.check(now, now - (back if k < 60 else then), moved(0.03)).action)
    assert actions[59] == "accept"  # the first step has healed
    assert actions[-1] == "accept"
    assert not g.is_stale(now)


def test_two_that_are_in_one_place_contradict_each_other():
    places = {"a": (0.0, 0.0, 0.0), "b": (0.01, 0.0, 0.02), "c": (0.02, 0.5, 0.0), "d": (3.0, 0, 0)}
    assert find_coincident(places, 0.03) == {"a": "b", "b": "a"}
    assert find_coincident(places, 0.01) == {}
    assert find_coincident({}, 1.0) == {}


def test_hands_in_one_place_give_no_lease_and_are_named(shapes):
    config = igrip.Config(targets="paper", commitment={"reliability": 0.0})
    estimator = igrip.Estimator(shapes, config)
    box = {"box": {"model": BOX, "position": [0.3, 0.0, 0.0], "orientation": UPRIGHT}}
    leases = []
    for k in range(30):
        right = [0.008 * k, 0.001 * (k % 3), 0.0]
        left = [right[0], right[1], 0.01 if 15 <= k < 20 else 0.2]
        hands = {"right": {"position": right}, "left": {"position": left}}
        said = estimator.update(igrip.Observation(t=k / 30.0, hands=hands, objects=box))
        [right] = [i for i in said if i.hand == "right"]
        leases.append(right.commitment is not None)
        if k == 16:
            assert right.reason == "contradictory: is where hand left is"
    assert any(leases[:15])
    assert not any(leases[15:20])
    assert any(leases[20:])
