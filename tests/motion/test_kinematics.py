"""The discounted fit against weighted least squares of all samples at once."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.motion import kinematics

TIME_CONSTANT = 0.06


def fitted(times, points):
    """Return position, velocity, acceleration after the last sample."""
    state, out = kinematics.new_fit()
    for t, (x, y, z) in zip(times, points, strict=True):
        kinematics.update_fit(state, t, x, y, z, TIME_CONSTANT, out)
    return out


def oracle(times, points):
    """Solve the same weighted least squares as one dense system, priors as rows."""
    age = (np.array(times) - times[-1]) / TIME_CONSTANT
    weight = np.sqrt(np.exp(age))
    design = np.stack([age**0, age, age**2], axis=1) * weight[:, None]
    prior = [
        [0.0, np.sqrt(kinematics.VELOCITY_PRIOR), 0.0],
        [0.0, 0.0, np.sqrt(kinematics.ACCELERATION_PRIOR)],
    ]
    target = np.concatenate([(points - points[-1]) * weight[:, None], np.zeros((2, 3))])
    c, *_ = np.linalg.lstsq(np.concatenate([design, prior]), target, rcond=None)
    return np.stack([c[0] + points[-1], c[1] / TIME_CONSTANT, 2.0 * c[2] / TIME_CONSTANT**2])


@pytest.mark.parametrize("seed", range(6))
def test_it_is_the_weighted_least_squares_of_all_samples(seed):
    rng = np.random.default_rng(seed)
    times = 100.0 + np.cumsum(rng.uniform(0.005, 0.08, 40))
    points = 5.0 + np.cumsum(rng.normal(0.0, 0.01, (40, 3)), axis=0)
    for count in (1, 2, 3, 10, 40):
        found = fitted(times[:count], points[:count])
        assert found == pytest.approx(oracle(times[:count], points[:count]), rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("rate", [15.0, 30.0, 120.0])
def test_a_steady_movement_is_found_at_any_rate(rate):
    times = np.arange(0.0, 1.0, 1.0 / rate)
    points = np.outer(times, [0.5, -0.2, 0.1])
    position, velocity, _ = fitted(times, points)
    # the prior of a hand at rest weighs more, the fewer samples there are
    assert velocity == pytest.approx([0.5, -0.2, 0.1], rel=0.1)
    assert position == pytest.approx(points[-1], abs=0.003)


def test_a_far_off_origin_costs_no_digits():
    rng = np.random.default_rng(1)
    times, points = np.arange(30) / 30.0, np.cumsum(rng.normal(0.0, 0.01, (30, 3)), axis=0)
    here, there = fitted(times, points), fitted(times + 1e6, points + 1e4)
    assert there[1:] == pytest.approx(here[1:], rel=1e-5, abs=1e-5)
