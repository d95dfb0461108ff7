"""Calibration and intervals against numbers worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.lab.evaluation.calibration import (
    brier_score,
    expected_calibration_error,
    interval_over_groups,
)


def test_error_by_hand():
    confidence = np.array([0.95, 0.95, 0.95, 0.95, 0.55, 0.55])
    correct = np.array([True, True, True, False, True, False])
    # bin 9: 0.95 against 0.75 (four answers); bin 5: 0.55 against 0.5 (two)
    assert expected_calibration_error(confidence, correct) == pytest.approx(
        (4 * 0.20 + 2 * 0.05) / 6
    )
    assert expected_calibration_error(np.array([1.0, 0.0]), np.array([True, False])) == 0.0
    assert np.isnan(expected_calibration_error(np.empty(0), np.empty(0, dtype=bool)))


def test_brier_by_hand():
    probability = np.array([[0.7, 0.2, 0.1], [0.0, 0.0, 1.0]])
    assert brier_score(probability, np.array([0, 0])) == pytest.approx(
        (0.09 + 0.04 + 0.01 + 1.0 + 1.0) / 2
    )
    assert np.isnan(brier_score(np.empty((0, 3)), np.empty(0, dtype=int)))


@given(st.integers(0, 999))
def test_who_states_what_is_true_has_no_error(seed):
    rng = np.random.default_rng(seed)
    confidence = rng.uniform(0.0, 1.0, 20_000)
    correct = rng.random(20_000) < confidence
    assert expected_calibration_error(confidence, correct) < 0.02


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
