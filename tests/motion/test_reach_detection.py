"""When a movement begins and ends, and what is kept of it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from igrip.lab.simulation.minimum_jerk import reach
from igrip.motion.reach_detection import ReachConfig, ReachDetector
from igrip.motion.reach_kernel import MAX_POINTS, extent_of, noise_variance_of, times_of
from oracle.reaches import Reaches

START, GOAL = np.array([0.1, 0.0, 0.05]), np.array([0.1, 0.4, 0.05])
RATES = (15.0, 30.0, 60.0, 120.0)


def followed(times, points, config=None):
    """Return what the detector says of each sample."""
    one = ReachDetector(config)
    return [one.update(float(t), p) for t, p in zip(times, points, strict=True)]


def a_reach(rate=30.0, rest=0.5, lasts=1.0, hold=0.6, noise=0.0, seed=0):
    """Return times and points of a hand that rests, reaches and stays."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, rest + lasts + hold, 1.0 / rate)
    points = reach(START, GOAL, 0.0, (times - rest) / lasts)
    return times, points + noise * rng.normal(size=points.shape)


def correlated(rng, count, sd, part):
    """Return noise that resembles that of the sample before, shape (count, 3)."""
    points = sd * rng.normal(size=(count, 3))
    for k in range(1, count):
        points[k] = part * points[k - 1] + math.sqrt(1.0 - part**2) * points[k]
    return points


def moving(found):
    return np.array([one.moving for one in found])


@pytest.mark.parametrize("rate", RATES)
def test_a_reach_is_one_movement_between_two_rests(rate):
    times, points = a_reach(rate)
    found = followed(times, points)
    moves = moving(found)
    assert (np.diff(moves.astype(int)) != 0).sum() == 2
    assert 0.5 < times[moves][0] < 0.8
    assert 1.35 < times[moves][-1] < 1.75


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("sd", [0.001, 0.002, 0.004])
def test_noise_neither_hides_a_reach_nor_splits_it(rate, sd):
    begins = []
    for seed in range(10):
        times, points = a_reach(rate, rest=1.0, noise=sd, seed=seed)
        moves = moving(followed(times, points))
        assert not moves[(times > 0.5) & (times < 1.0)].any()  # before, noise is not known yet
        assert moves[(times > 1.36) & (times < 1.75)].all()
        begins.append(times[moves][0])
    assert np.mean(begins) < 1.0 + 0.3


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("sd", [0.001, 0.002, 0.004, 0.008, 0.015])
def test_noise_at_rest_is_no_movement(rate, sd):
    rng = np.random.default_rng(7)
    times = np.arange(0.0, 120.0, 1.0 / rate)
    moves = moving(followed(times, sd * rng.normal(size=(len(times), 3))))
    settled = moves[times > 1.0]  # before, how noisy it is cannot be known
    assert settled.mean() < 0.002


@pytest.mark.parametrize("rate", RATES)
def test_slow_noise_of_a_depth_camera_is_seldom_a_movement(rate):
    rng = np.random.default_rng(8)
    times = np.arange(0.0, 120.0, 1.0 / rate)
    points = correlated(rng, len(times), 0.004, 0.6 ** (30.0 / rate))
    assert moving(followed(times, points))[times > 1.0].mean() < 0.01


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(("speed", "sd"), [(0.05, 0.0), (0.08, 0.0), (0.08, 0.002)])
def test_a_slow_hand_moves_too(rate, speed, sd):
    rng = np.random.default_rng(4)
    times = np.arange(0.0, 1.0 + 0.3 / speed, 1.0 / rate)
    points = np.outer(np.clip(times - 1.0, 0.0, None) * speed, [0.0, 1.0, 0.0])
    points += sd * rng.normal(size=points.shape)
    moves = moving(followed(times, points))
    late = times > 1.0 + 0.1 / speed  # a third of its way
    assert moves[late].mean() > 0.9


@pytest.mark.parametrize("rate", [15.0, 30.0, 120.0])
def test_start_peak_and_path_do_not_hang_on_the_rate(rate):
    one = followed(*a_reach(rate, hold=0.0))[-1]
    assert one.moving
    assert one.start == pytest.approx(START, abs=0.01)
    assert one.peak_speed == pytest.approx(1.875 * 0.4, rel=0.1)
    assert one.path_length == pytest.approx(0.4, rel=0.05)
    assert one.onset == pytest.approx(0.6, abs=0.1)
    assert one.elapsed == pytest.approx(0.9, abs=0.15)


def test_phases_of_a_reach():
    times, points = a_reach(60.0)
    phases = [one.phase for one in followed(times, points)]
    runs = [phase for phase, _ in itertools.groupby(phases)]
    assert runs[:3] == ["rest", "accelerating", "decelerating"]
    assert runs[-1] == "rest"
    turns = times[phases.index("decelerating")]
    assert turns == pytest.approx(1.0, abs=0.08)  # the peak of a minimum jerk is in its middle


def test_a_moment_of_rest_does_not_end_a_reach():
    times = np.arange(0.0, 2.0, 1.0 / 60.0)
    way = 0.4 * np.clip(times - 0.5, 0.0, 0.4) + 0.4 * np.clip(times - 0.95, 0.0, 10.0)
    found = followed(times, np.outer(way, [1.0, 0.0, 0.0]))
    assert all(one.moving for one, t in zip(found, times, strict=True) if t > 0.7)


def test_after_a_rest_on_the_way_the_reach_begins_anew_from_there():
    times = np.arange(0.0, 2.5, 1.0 / 60.0)
    way = 0.4 * np.clip(times - 0.5, 0.0, 0.5) + 0.4 * np.clip(times - 1.8, 0.0, 10.0)
    found = followed(times, np.outer(way, [1.0, 0.0, 0.0]))
    last = found[-1]
    assert [one.moving for one in found].count(False) > 30
    assert last.start == pytest.approx([0.2, 0.0, 0.0], abs=0.02)
    assert last.onset == pytest.approx(1.8, abs=0.1)


def test_at_rest_there_is_no_speed_and_no_time():
    for one in followed(np.arange(10) / 30.0, np.zeros((10, 3))):
        assert (one.phase, one.elapsed, one.peak_speed) == ("rest", 0.0, 0.0)


def test_a_hand_that_is_first_seen_moving_has_a_finite_onset():
    times = np.arange(8) / 30.0
    one = followed(times, np.outer(times, [0.7, 0.0, 0.0]))[-1]
    assert one.moving
    assert math.isfinite(one.onset)
    assert np.isfinite(one.start).all()


def test_a_long_movement_keeps_points_over_all_of_it():
    times = np.arange(0.0, 20.0, 1.0 / 60.0)
    around = np.stack([np.sin(2.0 * times), np.cos(2.0 * times), 0.0 * times], axis=1)
    kept = followed(times, 0.3 * around)[-1].points[:, 0]
    assert len(kept) <= MAX_POINTS
    assert (np.diff(kept) > 0.0).all()
    assert kept[0] < 1.0
    assert kept[-1] == times[-1]


def test_after_a_gap_nothing_is_known_of_the_movement_before():
    one = ReachDetector()
    for k in range(15):
        last = one.update(k / 30.0, (0.02 * k, 0.0, 0.0))
    assert last.moving
    after = one.update(0.5 + 0.6, (0.9, 0.0, 0.0))
    assert not after.moving
    assert after.start == pytest.approx([0.9, 0.0, 0.0])
    assert last.start == pytest.approx([0.0, 0.0, 0.0], abs=0.05)  # what was told stays as it was


def test_it_is_causal_and_a_shifted_clock_changes_nothing():
    times, points = a_reach(30.0, noise=0.003, seed=3)
    whole = [one.phase for one in followed(times, points)]
    assert [one.phase for one in followed(times[:25], points[:25])] == whole[:25]
    config = ReachConfig(min_rest_duration=0.09)  # no multiple of the time between two frames
    here = [one.phase for one in followed(times, points, config)]
    assert [one.phase for one in followed(times + 1e6, points, config)] == here


def wandering(seed, rate):
    """Return a hand that rests, reaches, goes back and reaches again, in noise, at uneven times."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.5, 1.5, int(3.5 * rate)) / rate)
    there = reach(START, GOAL, 0.05, (times - 0.7) / 0.8)
    back = reach(np.zeros(3), START - GOAL, 0.0, (times - 1.9) / 0.6)
    tremble = 0.01 * np.sin(np.outer(times, [9.0, 7.0, 0.0])) * (times < 0.5)[:, None]
    noise = rng.choice([0.0, 0.001, 0.004]) * rng.normal(size=there.shape)
    return times, there + back + tremble + noise


@pytest.mark.parametrize("rate", [20.0, 60.0])
@pytest.mark.parametrize("seed", range(5))
def test_every_number_is_that_of_plain_numpy(seed, rate):
    rng = np.random.default_rng([seed, int(rate)])
    config = ReachConfig(
        time_constant=rng.uniform(0.04, 0.1), onset_distance=rng.uniform(0.004, 0.02),
        onset_noise_factor=rng.uniform(2.0, 6.0), initial_noise=rng.uniform(0.001, 0.005),
        onset_sway_factor=rng.uniform(2.0, 6.0), max_onset_sway=rng.uniform(0.01, 0.05),
        rest_time_constant=rng.uniform(0.3, 2.0), end_time_constant=rng.uniform(0.05, 0.2),
        rest_speed=rng.uniform(0.02, 0.1), rest_speed_fraction=rng.uniform(0.05, 0.3),
        rest_noise_factor=rng.uniform(0.5, 3.0), min_rest_duration=rng.uniform(0.02, 0.2),
    )  # fmt: skip
    ours, oracle, moved = ReachDetector(config), Reaches(config), set()
    times, points = wandering(seed, rate)
    for k, (t, p) in enumerate(zip(times, points, strict=True)):
        if k == len(times) - 15:
            times[k:] += 0.6  # a gap longer than the limit: it begins anew
            t = times[k]
        found, expected = ours.update(t, p), oracle.update(t, p)
        moved.add(found.moving)
        assert found.moving == expected["moving"], k
        assert found.now == pytest.approx(expected["kinematics"], rel=1e-6, abs=1e-6)
        assert found.onset == pytest.approx(expected["onset"], abs=1e-12)
        assert found.start == pytest.approx(expected["start"], abs=1e-9)
        assert noise_variance_of(found.state) == pytest.approx(expected["variance"], rel=1e-6)
        assert found.points == pytest.approx(expected["points"], abs=1e-8)
        now, onset, peak_t = times_of(found.state)
        assert (now, onset) == (t, found.onset)
        if found.may_move:
            max_speed, path = extent_of(found.state)
            assert max_speed == pytest.approx(expected["max_speed"], rel=1e-6)
            assert peak_t == pytest.approx(expected["max_speed_t"])
            assert path == pytest.approx(expected["path"], rel=1e-6, abs=1e-9)
        if found.moving:
            assert found.elapsed == pytest.approx(t - expected["onset"])
            assert found.peak_speed == pytest.approx(expected["max_speed"], rel=1e-6)
            assert found.path_length == pytest.approx(expected["path"], rel=1e-6)
            assert found.phase == (
                "accelerating" if expected["max_speed_t"] == t else "decelerating"
            )
        else:
            assert (found.elapsed, found.peak_speed, found.path_length) == (0.0, 0.0, 0.0)
            assert found.phase == "rest"
    assert moved == {False, True}


def far_from_rest(metres, seconds=2.0, rate=30.0):
    """Return a detector that knows its hand to rest, and states of a jump by so much from there."""
    ours = ReachDetector(ReachConfig(initial_noise=1e-6, onset_distance=0.01))
    times = np.arange(0.0, seconds, 1.0 / rate)
    for t in times:
        rest = ours.update(float(t), (0.0, 0.0, 0.0))
    assert not rest.may_move
    return [ours.update(float(times[-1] + k / rate), (metres, 0.0, 0.0)) for k in (1, 2, 3)]


@pytest.mark.parametrize(
    ("metres", "moving", "may_move"),
    [
        (0.0045, [False, False, False], [False, False, False]),  # less than half of the distance
        (0.007, [False, False, False], [True, True, True]),
        (0.0135, [False, True, True], [True, True, True]),  # beyond it: two samples are needed
        (0.035, [True, True, True], [True, True, True]),  # twice as far: one is enough
    ],
)
def test_how_far_a_hand_must_go_to_move(metres, moving, may_move):
    found = far_from_rest(metres)
    assert [one.moving for one in found] == moving
    assert [one.may_move for one in found] == may_move


def test_a_long_movement_drops_every_second_point_once_it_is_full():
    ours, kept = ReachDetector(), []
    for k in range(MAX_POINTS + 40):
        last = ours.update(k / 60.0, (0.02 * k, 0.0, 0.0))
        kept.append(len(last.points))
        if kept[-1] == MAX_POINTS:
            full = last.points
    assert max(kept) == MAX_POINTS
    half = MAX_POINTS // 2
    assert kept[kept.index(MAX_POINTS) + 1] == half + 1
    assert (last.points[:half] == full[::2]).all()
    assert (np.diff(last.points[:, 0]) > 0.0).all()
