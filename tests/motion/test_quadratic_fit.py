"""The closed-form fit against least squares by singular values."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.motion.quadratic_fit import fit_quadratic
from oracle import motion


def fitted(times, positions):
    coefficients = np.full((3, 3), np.nan)
    positions = np.ascontiguousarray(positions, dtype=float)
    done = fit_quadratic(np.asarray(times, dtype=float), positions, coefficients)
    return coefficients if done else None


@pytest.mark.parametrize("count", [3, 4, 20, 200])
@pytest.mark.parametrize("start", [0.0, 1.7e9, 12_345.678])
def test_agrees_with_least_squares(count, start):
    rng = np.random.default_rng(count)
    times = start + np.cumsum(rng.uniform(0.02, 0.05, count))
    positions = rng.normal(0.0, 1.0, (count, 3))
    assert fitted(times, positions) == pytest.approx(motion.fit(times, positions), rel=1e-9)


@given(st.integers(0, 10_000), st.integers(3, 25), st.floats(-100.0, 100.0))
def test_any_window_far_from_the_origin(seed, count, offset):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.005, 0.1, count))
    walk = np.cumsum(rng.normal(0.0, 0.02, (count, 3)), axis=0)
    expected = motion.fit(times, walk)  # the oracle near the origin, where it loses no digits
    expected[0] += offset
    assert fitted(times, walk + offset) == pytest.approx(expected, rel=1e-7, abs=1e-9)


@given(st.lists(st.floats(-10, 10), min_size=9, max_size=9), st.integers(3, 20))
def test_a_parabola_is_found_exactly(numbers, count):
    true = np.array(numbers).reshape(3, 3)
    s = -np.linspace(0.6, 0.0, count)
    positions = np.stack([np.ones_like(s), s, s**2], axis=1) @ true
    assert fitted(5.0 + s, positions) == pytest.approx(true, abs=1e-8)


def test_newer_samples_weigh_more_as_one_over_one_plus_age():
    # a constant through values at two instants: c = Σ w y / Σ w if the curve may not bend or lean;
    # here instead: the weighted residuals are orthogonal to 1, s and s²
    rng = np.random.default_rng(1)
    times, positions = np.linspace(0.0, 0.9, 12), rng.normal(size=(12, 3))
    c = fitted(times, positions)
    s = times - times[-1]
    residual = positions - np.stack([np.ones_like(s), s, s**2], axis=1) @ c
    w = 1.0 / (1.0 - s)
    assert np.stack([w, w * s, w * s**2]) @ residual == pytest.approx(np.zeros((3, 3)), abs=1e-12)
    wrong = w**2  # np.polyfit squares its weights: that would not do
    assert np.abs(np.stack([wrong, wrong * s]) @ residual).max() > 1e-3


@pytest.mark.parametrize(
    "times",
    [[], [0.0], [0.0, 0.1], [1.0, 1.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0, 1.0]],
    ids=str,
)
def test_too_few_times_write_nothing(times):
    coefficients = np.full((3, 3), 7.0)
    positions = np.ones((len(times), 3))
    assert not fit_quadratic(np.array(times, dtype=float), positions, coefficients)
    assert (coefficients == 7.0).all()


def test_three_samples_nearly_at_one_time_are_refused_not_extrapolated():
    times = np.array([0.0, 1.0, 1.0 + 1e-15])
    assert fitted(times, np.array([[0, 0, 0], [1, 0, 0], [2.0, 0, 0]])) is None
