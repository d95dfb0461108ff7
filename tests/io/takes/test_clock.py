"""Times of a recording repaired."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.errors import DatasetError
from igrip.io.takes.clock import repair_times

RATE = 100.0
TIMES = np.arange(200) / RATE
MOVING = np.stack([TIMES, 0 * TIMES, 0 * TIMES], axis=1)  # 1 m/s
LINES = list(range(2, 202))


def repaired(times, positions=(MOVING,), **options):
    return repair_times(np.asarray(times, dtype=float), LINES, list(positions), **options)


def test_good_times_stay_to_the_bit():
    result = repaired(TIMES + 5.0)
    np.testing.assert_array_equal(result.times, (TIMES + 5.0) - 5.0)
    np.testing.assert_array_equal(result.rows, np.arange(200))
    assert result.remarks == []


@given(st.floats(-1e5, -1e-3), st.integers(7, 190))
def test_a_step_back_of_any_size_costs_nothing(step, k):
    result = repaired(np.where(np.arange(200) >= k, TIMES + step, TIMES))
    if step + 1 / RATE >= 0:
        return  # no step back
    np.testing.assert_allclose(result.times, TIMES, atol=1e-6)
    [remark] = result.remarks
    assert f"in line {k + 2}" in remark


@given(st.floats(1.5, 1e5), st.integers(7, 190))
def test_a_jump_ahead_in_a_movement_is_taken_out(step, k):
    result = repaired(np.where(np.arange(200) >= k, TIMES + step, TIMES))
    np.testing.assert_allclose(result.times, TIMES, atol=1e-6)
    assert f"in line {k + 2}" in result.remarks[0]


def test_a_jump_ahead_at_rest_is_a_gap():
    times = np.where(np.arange(200) >= 90, TIMES + 7.0, TIMES)
    result = repaired(times, [0 * MOVING])
    np.testing.assert_array_equal(result.times, times)
    assert "nothing was recorded for 7.01 s before line 92" in result.remarks[0]


def test_equal_times_are_merged_into_the_first():
    times = TIMES.copy()
    times[50:53] = times[50]
    result = repaired(times)
    assert len(result.times) == 198
    assert 51 not in result.rows
    assert "2 equal times merged, first in line 53" in result.remarks[0]


def test_rows_without_a_time_are_left_out():
    times = TIMES.copy()
    times[[3, 9]] = np.nan
    result = repaired(times)
    assert len(result.times) == 198
    assert "2 rows without a time left out, first in line 5" in result.remarks[0]


def test_midnight():
    result = repaired((TIMES + 86399.0) % 86400.0, of_day=True)
    np.testing.assert_allclose(result.times, TIMES, atol=1e-6)
    assert result.remarks == []


def test_rows_in_no_order_are_sorted():
    order = np.random.default_rng(0).permutation(200)
    result = repaired(TIMES[order], [MOVING[order]])
    np.testing.assert_allclose(result.times, TIMES)
    np.testing.assert_array_equal(order[result.rows], np.arange(200))


@pytest.mark.parametrize("times", [[np.nan] * 200, [1.0] * 200])
def test_times_that_never_increase(times):
    with pytest.raises(DatasetError, match="times do not increase"):
        repaired(times)
