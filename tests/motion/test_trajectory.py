"""Window, prediction and peak speed against the oracle."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.motion.trajectory import MotionConfig, Trajectory
from oracle import filters, motion

FILTER = {"min_cutoff": 1.5, "beta": 5.0, "derivative_cutoff": 1.0}


def samples(rng, count, rate, gaps=()):
    times = 3.0 + np.arange(count) / rate + rng.uniform(-0.2, 0.2, count) / rate
    for gap in gaps:
        times[gap:] += 0.25
    return times, np.cumsum(rng.normal(0.01, 0.01, (count, 3)), axis=0)


@pytest.mark.parametrize("window", [3, 4, 20, 33])
@pytest.mark.parametrize("duration", [0.15, 1.0])
def test_agrees_with_the_oracle(window, duration):
    rng = np.random.default_rng(window)
    times, points = samples(rng, 90, 30.0, gaps=(20, 21, 60))
    config = MotionConfig(window=window, window_duration=duration, future_points=7, horizon=0.2)
    filtered, _, _ = filters.one_euro_points(times, points, **FILTER)
    expected = motion.motions(times, filtered, size=window, duration=duration)
    trajectory = Trajectory(config)
    answered = 0
    for k in range(90):
        ours = trajectory.update(times[k], tuple(points[k]))
        window_k = motion.window_of(times, k, window, duration)
        assert len(trajectory) == len(window_k)
        assert trajectory.past == pytest.approx(filtered[window_k], rel=1e-12)
        if expected[k] is None:
            assert ours is None
            continue
        answered += 1
        coefficients, speed, peak = expected[k]
        future, velocity = motion.future(coefficients, 7, 0.2)
        assert ours.t == times[k]
        assert ours.position == pytest.approx(filtered[k], rel=1e-12)
        assert ours.coefficients == pytest.approx(coefficients, rel=1e-8, abs=1e-9)
        assert ours.velocity == pytest.approx(coefficients[1], rel=1e-8, abs=1e-9)
        assert ours.speed == pytest.approx(speed, rel=1e-9)
        assert ours.future == pytest.approx(future, rel=1e-8, abs=1e-9)
        assert ours.future_velocity == pytest.approx(velocity, rel=1e-8, abs=1e-9)
        assert ours.window_peak_speed == (None if peak is None else pytest.approx(peak, rel=1e-9))
    assert answered > 60


def test_the_last_predicted_point_is_at_the_horizon():
    trajectory = Trajectory(MotionConfig(filter={"min_cutoff": 1e6}))
    for k in range(10):
        found = trajectory.update(k / 30, (0.5 * k / 30, 0.0, 0.0))
    assert len(found.future) == 10
    assert found.future[-1] - found.position == pytest.approx([0.15, 0.0, 0.0], abs=1e-6)
    assert found.future[0] - found.position == pytest.approx([0.015, 0.0, 0.0], abs=1e-6)


def test_a_motion_is_not_changed_by_later_samples():
    trajectory = Trajectory(MotionConfig(window=4))
    rng = np.random.default_rng(0)
    kept = []
    for k in range(40):
        found = trajectory.update(k / 30, tuple(rng.normal(size=3)))
        if found is not None:
            kept.append((found, found.position.copy(), found.coefficients.copy()))
    for found, position, coefficients in kept:
        assert (found.position == position).all()
        assert (found.coefficients == coefficients).all()


def test_reset_is_as_new():
    rng = np.random.default_rng(1)
    times, points = samples(rng, 30, 30.0)
    used, new = Trajectory(MotionConfig()), Trajectory(MotionConfig())
    for t, point in zip(times, points, strict=True):
        used.update(t - 2.0, tuple(point + 1.0))
    used.reset()
    assert len(used) == 0
    for t, point in zip(times, points, strict=True):
        a, b = used.update(t, tuple(point)), new.update(t, tuple(point))
        assert (a is None) == (b is None)
        if a is not None:
            assert (a.coefficients == b.coefficients).all()
            assert a.window_peak_speed == b.window_peak_speed
            assert all(
                np.array_equal(x, y, equal_nan=True) for x, y in zip(a.reach, b.reach, strict=True)
            )
