"""When a movement begins and ends, and what is kept of it."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.motion import course
from igrip.motion.course import Course
from igrip.simulation.minimum_jerk import reach

START, GOAL = np.array([0.1, 0.0, 0.05]), np.array([0.1, 0.4, 0.05])


def followed(rate=30.0, rest=0.5, lasts=1.0, hold=0.6, noise=0.0, seed=0):
    """Return the movement at last and, for each sample of a reach, whether the hand moves."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, rest + lasts + hold, 1.0 / rate)
    points = reach(START, GOAL, 0.0, (times - rest) / lasts)
    points += noise * rng.normal(size=points.shape)
    one = Course()
    seen = [one.update(t, p) for t, p in zip(times, points, strict=True)]
    return seen[-1], times, np.array([movement.moving for movement in seen])


@pytest.mark.parametrize("rate", [15.0, 30.0, 60.0, 120.0])
def test_a_reach_is_one_movement_between_two_rests(rate):
    one, times, moves = followed(rate)
    begins, ends = times[moves][0], times[moves][-1]
    assert (np.diff(moves.astype(int)) != 0).sum() == 2
    assert 0.5 < begins < 0.75
    assert 1.35 < ends < 1.75
    assert not one.moving


@pytest.mark.parametrize("rate", [15.0, 30.0, 120.0])
def test_start_peak_and_path_do_not_hang_on_the_rate(rate):
    one, *_ = followed(rate, hold=0.0, lasts=1.0)
    assert one.moving
    assert one.state[course.START : course.START + 3] == pytest.approx(START, abs=0.015)
    assert one.state[course.PEAK] == pytest.approx(1.875 * 0.4, rel=0.1)
    assert one.state[course.PATH] == pytest.approx(0.4, rel=0.05)
    assert one.state[course.ONSET] == pytest.approx(0.5, abs=0.2)


def test_a_long_movement_keeps_points_over_all_of_it():
    one = Course()
    times = np.arange(0.0, 20.0, 1.0 / 60.0)
    for t in times:
        last = one.update(t, (0.3 * np.sin(2.0 * t), 0.3 * np.cos(2.0 * t), 0.0))
    kept = last.points[:, 0]
    assert len(kept) <= course.MOST_POINTS
    assert (np.diff(kept) > 0.0).all()
    assert kept[0] < 1.0
    assert kept[-1] == times[-1]


def test_after_a_gap_nothing_is_known_of_the_movement_before():
    one = Course()
    for k in range(15):
        last = one.update(k / 30.0, (0.02 * k, 0.0, 0.0))
    assert last.moving
    after = one.update(0.5 + 0.6, (0.9, 0.0, 0.0))
    assert not after.moving
    assert after.start == pytest.approx([0.9, 0.0, 0.0])
    assert last.start == pytest.approx([0.0, 0.0, 0.0], abs=0.03)  # what was told stays as it was


def test_noise_at_rest_is_no_long_movement():
    one = Course()
    rng = np.random.default_rng(3)
    moves = [one.update(k / 30.0, 0.002 * rng.normal(size=3)).moving for k in range(600)]
    assert np.mean(moves) < 0.1
