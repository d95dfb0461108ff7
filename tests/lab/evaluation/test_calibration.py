"""Calibration and intervals against numbers worked out by hand."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.lab.evaluation.calibration import (
    ReliabilityBins,
    interval_over_groups,
    squared_error,
)


def calibration_error(stated, correct):
    return ReliabilityBins.of(stated, correct).calibration_error()


def test_error_by_hand():
    stated = [0.95, 0.95, 0.95, 0.95, 0.55, 0.55]
    correct = [True, True, True, False, True, False]
    # bin 9: 0.95 against 0.75 (four answers); bin 5: 0.55 against 0.5 (two)
    assert calibration_error(stated, correct) == pytest.approx((4 * 0.20 + 2 * 0.05) / 6)
    assert calibration_error([1.0, 0.0], [True, False]) == 0.0
    assert np.isnan(calibration_error([], []))


def test_too_little_confidence_in_one_bin_does_not_make_up_for_too_much_in_another():
    """Stated 0.9 and correct in half, stated 0.5 and correct in nine tenths: 0.4 off everywhere."""
    stated = [0.9] * 10 + [0.5] * 10
    correct = [True] * 5 + [False] * 5 + [True] * 9 + [False]
    assert calibration_error(stated, correct) == pytest.approx(0.4)


def test_bins_have_equal_width_and_add_up():
    bins = ReliabilityBins.of([0.0, 0.05, 0.3, 0.99, 1.0], [True, False, True, True, False])
    assert bins.answers.tolist() == [2, 0, 0, 1, 0, 0, 0, 0, 0, 2]
    assert bins.stated[[0, 3, 9]] == pytest.approx([0.05, 0.3, 1.99])
    assert bins.correct.tolist() == [1, 0, 0, 1, 0, 0, 0, 0, 0, 1]
    half = ReliabilityBins.of([0.0, 0.05], [True, False])
    rest = ReliabilityBins.of([0.3, 0.99, 1.0], [True, True, False])
    together = ReliabilityBins(*(a + b for a, b in zip(half, rest, strict=True)))
    assert together.calibration_error() == pytest.approx(bins.calibration_error())


def test_squared_error_by_hand():
    probability = {"cup": 0.7, "can": 0.2, "none": 0.1}
    assert squared_error(probability, "cup") == pytest.approx(0.09 + 0.04 + 0.01)
    assert squared_error(probability, "none") == pytest.approx(0.49 + 0.04 + 0.81)
    assert squared_error({"cup": 0.0, "can": 1.0}, "cup") == 2.0
    assert squared_error({"cup": 1.0}, "cup") == 0.0


def test_a_target_without_a_probability_was_given_none():
    """As if it had a probability of 0: the squared error is 1 more, not 0 more."""
    given = squared_error({"can": 0.6, "none": 0.4, "cup": 0.0}, "cup")
    assert squared_error({"can": 0.6, "none": 0.4}, "cup") == pytest.approx(given)
    assert given == pytest.approx(0.36 + 0.16 + 1.0)


@given(st.integers(0, 999))
def test_who_states_what_is_true_has_no_error(seed):
    rng = np.random.default_rng(seed)
    stated = rng.uniform(0.0, 1.0, 20_000)
    assert calibration_error(stated, rng.random(20_000) < stated) < 0.02


def test_interval_is_over_people_and_not_over_trials():
    """Two people, one always right and one never: nobody knows the mean, however many trials."""
    values = np.repeat([0.0, 1.0], 1000)
    low, high = interval_over_groups(values, np.repeat([0, 1], 1000))
    assert (low, high) == (0.0, 1.0)
    trials = np.random.default_rng(0).random(2000) < 0.5
    low, high = interval_over_groups(trials.astype(float), np.arange(2000) % 20)
    assert 0.45 < low < 0.5 < high < 0.55
    assert np.isnan(interval_over_groups(values, np.zeros(2000, dtype=int))).all()
    with_gaps = np.where(np.arange(2000) % 3 == 0, np.nan, values)
    assert np.isfinite(interval_over_groups(with_gaps, np.arange(2000) % 5)).all()


def test_flags_of_which_some_are_unknown():
    flags = pd.Series([True, None, False, True, None, False], dtype=object)
    people = pd.Series(["a", "a", "a", "b", "b", "c"])
    known = interval_over_groups([1.0, 0.0, 1.0, 0.0], [0, 0, 1, 2])
    assert interval_over_groups(flags, people) == known


def test_interval_of_a_known_distribution():
    """Three people: a resampled mean is 0, 1/3, 2/3 or 1 with known probabilities."""
    values, groups = np.array([0.0, 0.0, 1.0]), np.array([0, 1, 2])
    assert interval_over_groups(values, groups) == (0.0, 1.0)  # 8/27 and 1/27 of the draws
    low, high = interval_over_groups(values, groups, level=0.6)
    assert (low, high) == (0.0, pytest.approx(2 / 3))  # 20 % and 80 %


def test_people_with_more_trials_weigh_more():
    values = np.array([1.0] * 9 + [0.0])
    low, high = interval_over_groups(values, np.array([0] * 9 + [1]), level=0.2)
    assert (low, high) == pytest.approx((0.9, 0.9))  # both drawn once, in half of the draws
    assert interval_over_groups(values, np.array([5] * 9 + [7])) == (0.0, 1.0)


def test_draws_and_seed_matter_and_repeat():
    values = np.random.default_rng(1).random(40)
    groups = np.arange(40) % 8
    first = interval_over_groups(values, groups)
    assert interval_over_groups(values, groups) == first
    assert interval_over_groups(values, groups, seed=1) != first
    assert interval_over_groups(values, groups, draws=100) != first
    assert interval_over_groups(values, groups, draws=2000, level=0.95, seed=0) == first


def test_interval_is_that_of_the_percentiles():
    """One person of five is right: a resampled mean is binomial, and 0.4 at 90 %."""
    values = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    assert interval_over_groups(values, list("abcde"), level=0.8) == (0.0, pytest.approx(0.4))
