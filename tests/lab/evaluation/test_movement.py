"""Onset and end of movements that can be counted on paper."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import butter, filtfilt

from igrip.lab.evaluation.movement import movement_bounds, smooth_speeds


def bounds(speeds):
    return movement_bounds(np.arange(len(speeds), dtype=float), np.array(speeds, dtype=float))


@pytest.mark.parametrize(
    ("speeds", "expected"),
    [
        ([0, 1, 5, 10, 5, 1, 0], (2, 6)),  # 1 is not more than 10 % of 10, and not less either
        ([0, 2, 10, 4, 2, 3, 2], (1, 4)),  # least after: 2; below 2 + 0.8
        ([0, 10, 0], None),  # no sample before the peak is fast enough to be an onset
        ([0, 5, 10], None),  # it never ends
        ([10, 5, 0], None),  # it never begins
        ([0, 0, 0, 0], None),
        ([1, 2], None),
        ([0, 5, np.nan, 3, 0], None),
        ([0, 3, 9, 9, 3, 0], (1, 5)),  # two equal peaks: the first
        ([5, 10, 0], (0, 2)),
        ([0, 2, 10, 3, 2, 2], (1, 4)),  # 3 is not below 2 + 0.8
        ([0, 3, 0, 4, 10, 4, 0], (1, 6)),  # the first rise
    ],
)
def test_by_hand(speeds, expected):
    assert bounds(speeds) == expected


@pytest.mark.parametrize(
    ("speeds", "expected"),
    [
        ([0, 3, 0, 4, 10, 4, 0], (3, 6)),  # the last rise
        ([0, 3, 1, 4, 10, 4, 0], (3, 6)),  # 1 is not more than 10 % of 10
        ([3, 4, 10, 4, 0], (0, 4)),
        ([0, 3, 0, 10, 4, 0], None),
    ],
)
def test_of_a_measured_trace(speeds, expected):
    times = np.arange(len(speeds), dtype=float)
    assert movement_bounds(times, np.array(speeds, dtype=float), noisy=True) == expected


@given(st.floats(0.5, 3.0), st.floats(0.1, 0.9))
def test_of_a_minimum_jerk_reach(duration, distance):
    """Speed 30 d/T s²(1-s)²: 10 % of its peak at s = 0.0867 and its mirror image."""
    t = np.arange(0.0, duration + 1.0, 0.001)
    s = np.clip((t - 0.5) / duration, 0.0, 1.0)
    onset, end = movement_bounds(t, 30.0 * distance / duration * (s * (1.0 - s)) ** 2)
    inner = np.sqrt(0.1) / 4.0  # s (1 - s) at a tenth of the peak
    part = 0.5 - np.sqrt(0.25 - inner)
    assert onset == pytest.approx(0.5 + part * duration, abs=0.0021)
    assert end == pytest.approx(0.5 + (1.0 - part) * duration, abs=0.0021)


def test_the_filter_has_no_lag():
    t = np.arange(0.0, 3.0, 1 / 30)
    s = np.clip((t - 1.0) / 1.2, 0.0, 1.0)
    path = 0.4 * s**3 * (10 - 15 * s + 6 * s * s)
    trace = np.stack([path, 0 * path, 0 * path], axis=1)
    trace += np.random.default_rng(0).normal(0.0, 0.002, trace.shape)
    times, speeds = smooth_speeds(t, trace)
    assert times[np.argmax(speeds)] == pytest.approx(1.6, abs=0.07)
    onset, end = movement_bounds(times, speeds)
    assert onset == pytest.approx(1.1, abs=0.08)
    assert end == pytest.approx(2.1, abs=0.12)


def test_gaps_are_bridged_and_short_traces_refused():
    t = np.array([0.0, 0.1, 0.2, 0.3, 0.9, *np.arange(1.0, 3.0, 0.1)])
    line = np.stack([t, 0 * t, 0 * t], axis=1)
    times, speeds = smooth_speeds(t, line)
    assert np.diff(times) == pytest.approx(0.1)
    assert speeds[3:-3] == pytest.approx(1.0, abs=0.02)
    for short in (t[:2], t[5:20]):
        assert [part.shape for part in smooth_speeds(short, line[: len(short)])] == [(0,), (0,)]
    assert movement_bounds(*smooth_speeds(t[:5], line[:5])) is None


def test_noise_at_rest_is_no_onset():
    """The truth is known: 200 noisy traces of one minimum-jerk reach, with outliers."""
    rng = np.random.default_rng(1)
    t = np.arange(0.0, 4.0, 1 / 30)
    s = np.clip((t - 1.5) / 1.2, 0.0, 1.0)
    path = 0.4 * s**3 * (10 - 15 * s + 6 * s * s)
    late = []
    for _ in range(200):
        trace = np.stack([path, 0 * path, 0 * path], axis=1) + rng.normal(0, 0.003, (len(t), 3))
        trace[rng.integers(len(t))] += rng.normal(0.0, 0.1, 3)
        onset, _ = movement_bounds(*smooth_speeds(t, trace), noisy=True)
        late.append(onset - (1.5 + 0.0867 * 1.2))
    assert np.mean(np.abs(late) < 0.1) > 0.9
    assert abs(np.median(late)) < 0.05


def test_a_jump_of_the_clock_is_no_movement():
    jumped = np.array([*np.arange(0.0, 3.0, 1 / 30), 5e8])
    for t in (jumped, np.zeros(90)):  # or a clock that stands still
        assert [part.shape for part in smooth_speeds(t, np.zeros((len(t), 3)))] == [(0,), (0,)]


def oracle(t, trace, rate):
    """Return the speeds of an even trace, with the filter in another form."""
    padded = np.pad(trace, ((2, 2), (0, 0)), mode="reflect")
    steady = np.median([padded[k : k + len(trace)] for k in range(5)], axis=0)
    b, a = butter(2, min(6.0, 0.45 * rate), fs=rate)
    smooth = filtfilt(b, a, steady, axis=0, padlen=15)
    return np.linalg.norm(np.gradient(smooth, 1.0 / rate, axis=0), axis=1)


@pytest.mark.parametrize(("n", "rate"), [(90, 30.0), (16, 30.0), (40, 8.0)])
def test_of_an_even_trace(n, rate):
    t = 5.0 + np.arange(n) / rate
    trace = np.cumsum(np.random.default_rng(0).normal(0.0, 0.01, (n, 3)), axis=0)
    times, speeds = smooth_speeds(t, trace)
    assert times == pytest.approx(t)
    assert speeds == pytest.approx(oracle(t, trace, rate), rel=1e-6)


def test_most_of_a_trace_may_be_a_gap_but_not_nearly_all():
    """40 samples at 10 Hz last 3.9 s; with gaps they may last up to 80 s."""
    t = np.arange(40) / 10
    for begin in (0.0, 1000.0):
        for last, smooth in ((79.9, True), (80.1, False)):
            times = begin + np.array([*t[:-1], last])
            assert bool(len(smooth_speeds(times, np.zeros((40, 3)))[0])) == smooth
