"""The noise of samples, against what was put in."""

from __future__ import annotations

import math

import numpy as np
import pytest

from igrip.lab.simulation.minimum_jerk import reach
from igrip.motion import noise


def estimated(times, points, memory=1.0, first=0.002):
    """Return the standard deviation after the last sample [m]."""
    state = noise.new_noise(first**2)
    for t, p in zip(times, points, strict=True):
        noise.update_noise(state, t, *p, memory)
    return math.sqrt(noise.variance_of(state))


@pytest.mark.parametrize("rate", [15.0, 30.0, 120.0])
@pytest.mark.parametrize("sd", [0.0005, 0.002, 0.008, 0.02])
def test_white_noise_is_measured_at_any_rate(rate, sd):
    rng = np.random.default_rng(1)
    times = np.arange(0.0, 20.0, 1.0 / rate)
    found = [estimated(times, sd * rng.normal(size=(len(times), 3)), memory=5.0) for _ in range(8)]
    assert np.mean(found) == pytest.approx(sd, rel=0.1)


@pytest.mark.parametrize("rate", [15.0, 30.0, 120.0])
def test_a_reach_is_not_taken_for_noise(rate):
    times = np.arange(0.0, 0.5, 1.0 / rate)
    points = reach(np.zeros(3), np.array([0.0, 0.4, 0.0]), 0.05, times / 0.8)
    assert estimated(times, points) < (0.004 if rate == 15.0 else 0.002)


def test_no_parabola_at_no_spacing_counts():
    rng = np.random.default_rng(2)
    times = np.cumsum(rng.uniform(0.01, 0.1, 40))
    points = np.outer(times**2, [1.0, -2.0, 0.5]) + np.outer(times, [3.0, 0.0, 1.0])
    assert estimated(times, points, memory=0.05) < 1e-5


def test_one_outlier_does_not_drown_the_rest():
    rng = np.random.default_rng(3)
    points = 0.002 * rng.normal(size=(60, 3))
    points[50] += 0.5
    assert estimated(np.arange(60) / 30.0, points) < 0.006
