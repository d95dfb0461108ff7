"""Where a body was lost."""

import numpy as np
import pytest

from igrip.io.takes.gaps import find_lost

COURSE = np.linspace([200.0, 0.0, 50.0], [-80.0, 340.0, 100.0], 200)


@pytest.mark.parametrize("value", [0.0, -9999.0, 9999.0, -99999.0, np.nan])
@pytest.mark.parametrize("rows", [slice(0, 20), slice(90, 110), slice(180, 200)])
def test_a_run_of_a_number_that_means_not_there(value, rows):
    points = COURSE.copy()
    points[rows] = value
    lost = find_lost(points)
    expected = np.zeros(200, dtype=bool)
    expected[rows] = True
    np.testing.assert_array_equal(lost.rows, expected)


def test_a_hand_that_comes_through_the_origin_was_there():
    points = np.linspace([-100.0, 0.0, 0.0], [100.0, 0.0, 0.0], 201)
    assert points[100].tolist() == [0.0, 0.0, 0.0]
    assert not find_lost(points).rows.any()


def test_a_hand_that_rests_at_the_origin_was_there():
    points = np.concatenate([np.zeros((50, 3)), np.cumsum(np.full((100, 3), 0.5), axis=0)])
    assert not find_lost(points).rows.any()


def test_zeros_of_a_system_that_writes_them():
    points = np.concatenate([np.zeros((50, 3)), np.cumsum(np.full((100, 3), 0.5), axis=0)])
    assert find_lost(points, zero_is_missing=True).rows.sum() == 50


def test_one_coordinate_that_is_missing_loses_the_row():
    points = COURSE.copy()
    points[7, 1] = np.nan
    assert np.flatnonzero(find_lost(points).rows).tolist() == [7]
