"""The offset of a sender's clock over steps, rates, jitter, loss and drift, on virtual clocks."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from igrip.runtime.clock_offset import ClockOffset

STEPS = (0.05, 0.1, 0.25, 0.4, 0.5, 0.7, 0.9, 1.0, 2.5, 60.0, 3600.0, 3 * 86400.0)
RATES = (10, 15, 20, 30, 60, 100, 120, 240)
WAY = 0.01  # s that every message takes at least
STEPPED_AT, END = 4.0, 8.0  # s
MAX_RELOCK = 2.0  # s


class Seen(NamedTuple):
    t: float  # when it was measured
    late: float  # on the way beyond the constant part [s]
    age: float  # by the model [s]
    trusted: bool


def simulate(step=0.0, rate=30, jitter=0.0, loss=0.0, drift=0.0, seed=0, late=lambda t: 0.0,
             end=END, uneven=0.0):  # fmt: skip
    """Return the model, and what it makes of messages of a clock that steps."""
    random = np.random.default_rng(seed)
    model, seen, arrived = ClockOffset("cam"), [], 0.0
    measured = np.arange(0.0, end, 1.0 / rate)
    measured += uneven / rate * random.uniform(-1.0, 1.0, len(measured)) if uneven else 0.0
    for t in measured.tolist():
        if random.random() < loss:
            continue
        sent = 1000.0 + t * (1.0 + drift) + (step if t >= STEPPED_AT else 0.0)
        arrived = max(arrived, t + WAY + jitter * random.random() + late(t))  # in order, as in TCP
        offset = model.update(sent, arrived)
        age = arrived - sent - offset
        seen.append(Seen(t, arrived - t - WAY, age, model.distrust is None))
    return model, seen


def check(seen, jitter, loss, rate, step):
    """The clock is followed again within two seconds, and no trusted age is much too small."""
    # what cannot be told from one lost message in a regular stream may stay: it only adds age
    error = 0.03 + 0.5 * jitter + (2.0 / rate if loss else 0.0)
    settled = [s for s in seen if s.t >= STEPPED_AT + MAX_RELOCK]
    assert all(s.trusted for s in settled)
    assert max(s.age - s.late for s in settled) < error
    hidden = min(abs(step), max(0.05, jitter)) if step > 0.0 else 0.0
    trusted = [s for s in seen if s.trusted and s.t > 2.0]
    assert max(s.late - s.age for s in trusted) < 0.02 + 0.5 * jitter + hidden
    assert all(s.trusted for s in seen if s.t < STEPPED_AT)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(("jitter", "loss"), [(0.0, 0.0), (0.005, 0.1), (0.03, 0.02), (0.08, 0.2)])
def test_every_step_is_followed_within_two_seconds(rate, jitter, loss):
    for step, sign in itertools.product(STEPS, (-1.0, 1.0)):
        drift = 2e-4 * sign
        model, seen = simulate(sign * step, rate, jitter, loss, drift, seed=rate)
        check(seen, jitter, loss, rate, sign * step)
        if step > 2.0 * jitter + 0.05:
            assert model.counts["steps"] == 1
            assert f"stepped {'ahead' if sign > 0 else 'back'}" in model.event


@pytest.mark.parametrize("step", [0.07, -0.05, 0.4, -0.4, 1e6, -1e6])
def test_a_fast_sender_is_followed(step):
    model, seen = simulate(step, 1000, 0.01, 0.2, seed=1, end=6.5)
    check(seen, 0.01, 0.2, 1000, step)
    assert model.counts["steps"] == 1


@pytest.mark.parametrize("rate", [10, 15])
@pytest.mark.parametrize("periods", [1, 2, 3, 10])
def test_an_uneven_sender_that_steps_by_whole_periods_is_followed(rate, periods):
    for seed in range(30):
        model, seen = simulate(-periods / rate, rate, 0.005, uneven=0.15, seed=seed)
        check(seen, 0.005, 0.0, rate, -periods / rate)
        assert model.counts["steps"] == 1


@settings(max_examples=80, deadline=None)
@given(
    st.floats(0.05, 1e6), st.sampled_from([-1.0, 1.0]), st.floats(10.0, 240.0),
    st.floats(0.0, 0.08), st.floats(0.0, 0.2), st.floats(-2e-4, 2e-4), st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_any_step_is_followed(step, sign, rate, jitter, loss, drift, seed):
    _, seen = simulate(sign * step, rate, jitter, loss, drift, seed)
    check(seen, jitter, loss, rate, sign * step)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(15.0, 240.0), st.floats(0.0, 0.05), st.floats(0.05, 3.0), st.floats(-2e-4, 2e-4),
    st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_lateness_is_never_taken_for_another_clock(rate, jitter, extra, drift, seed):
    """It grows with a gap in the arrivals, the sender's own times are regular: it is age."""

    def late(t):
        return extra if t >= STEPPED_AT else 0.0

    model, seen = simulate(0.0, rate, jitter, 0.0, drift, seed, late)
    assert model.counts["steps"] == 0
    assert max(s.late - s.age for s in seen if s.trusted and s.t > 2.0) < 0.01 + 0.5 * jitter


@pytest.mark.parametrize("size", [0.2, -0.2, 5.0, -5.0, 1e6, -1e6])
@pytest.mark.parametrize("at", [0, 1, 2, 3, 60, 100])
def test_one_odd_time_costs_little(size, at):
    model, ages = ClockOffset(), []
    for k in range(200):
        t = k / 30.0
        offset = model.update(50.0 + t + (size if k == at else 0.0), t)
        ages.append(abs(t - (50.0 + t) - offset) if model.distrust is None and k != at else None)
    assert sum(age is None for age in ages) <= 10
    assert all(age is None or age < 1e-3 for age in ages[at + 10 :])


def test_a_stall_and_its_burst_are_age_and_leave_nothing_behind():
    def late(t):
        return max(0.0, 6.0 - t) if t > 4.0 else 0.0

    model, seen = simulate(late=late)
    assert model.counts == {}
    assert max(abs(s.age - s.late) for s in seen) < 0.002


def test_a_clock_that_stands_still_is_not_followed():
    model = ClockOffset("cam")
    for k in range(300):
        model.update(50.0 + min(k, 100) / 30.0, k / 30.0)
    assert "clock of cam" in model.distrust


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_times_of_another_unit_are_not_trusted_and_the_unit_is_named(factor, unit):
    model = ClockOffset("cam")
    for k in range(60):
        model.update(factor * k / 30.0, k / 30.0)
    assert f"are they {unit} (--time-unit {unit})?" in model.distrust


def test_drift_is_estimated():
    model, _ = simulate(jitter=0.005, drift=1.5e-4, end=60.0)
    assert model.drift == pytest.approx(1.5e-4, abs=3e-5)
    assert model.report()["drift_ppm"] == pytest.approx(150.0, abs=30.0)


def test_after_a_pause_a_steady_delay_may_be_another_clock():
    model = ClockOffset()
    times = [k / 30.0 for k in range(60)] + [10.0123 + k / 30.0 for k in range(90)]
    trusted = []
    for t in times:
        model.update(100.0 + t - (0.5 if t > 5.0 else 0.0), t)
        trusted.append(model.distrust is None)
    assert all(trusted[:60])
    assert not any(trusted[60:100])  # no permission before it has been steady for 1.5 s
    assert trusted[-1]
    assert "stepped back" in model.event


def test_what_drains_after_an_outage_is_late_and_no_other_clock():
    model = ClockOffset()
    for k in range(60):
        model.update(100.0 + k / 30.0, k / 30.0)
    for k in range(60):  # sent from 3.5 s on, arriving at double speed from 5.5 s on
        sent = 3.5 + k / 30.0
        arrived = 5.5 + k / 60.0
        offset = model.update(100.0 + sent, arrived)
        assert model.distrust is not None or arrived - 100.0 - sent - offset > 0.9 * (
            arrived - sent
        )
    assert model.counts["steps"] == 0
