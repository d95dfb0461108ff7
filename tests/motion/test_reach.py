"""The causal detector of reaches, over speeds that are given."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from igrip.motion.reach import ReachConfig, ReachDetector

RATE = 30.0


def follow(speeds, config=None):
    """Return what the detector says of each speed; the hand moves along x."""
    detector = ReachDetector(config or ReachConfig())
    x, found = 0.0, []
    for k, speed in enumerate(speeds):
        x += speed / RATE
        found.append(detector.update(k / RATE, (x, 0.0, 0.0), speed))
    return found


def bell(peak=0.8, count=24):
    s = np.linspace(0.0, 1.0, count)
    return (peak * 16.0 * s**2 * (1.0 - s) ** 2).tolist()


def test_a_reach_from_rest_to_rest():
    speeds = [0.01] * 10 + bell() + [0.01] * 10
    found = follow(speeds)
    phases = [reach.phase for reach in found]
    first = next(k for k, speed in enumerate(speeds) if speed > 0.10)
    peak = int(np.argmax(speeds))
    assert phases[:first] == ["rest"] * first
    assert phases[first : peak + 1] == ["accelerating"] * (peak + 1 - first)
    assert phases[peak + 2] == "decelerating"
    assert phases[-1] == "rest"
    assert sum(a != b for a, b in itertools.pairwise(phases)) == 3


def test_onset_is_dated_back_to_the_last_rest():
    speeds = [0.01] * 5 + [0.06, 0.08, 0.12, 0.3, 0.5]
    found = follow(speeds)
    last_rest = 4
    assert found[-1].onset == pytest.approx(last_rest / RATE)
    assert found[-1].start == pytest.approx((0.05 / RATE, 0.0, 0.0))
    assert found[-1].elapsed == pytest.approx((len(speeds) - 1 - last_rest) / RATE)
    assert found[-1].peak_speed == 0.5


def test_a_slow_moment_does_not_end_a_reach():
    speeds = [0.01] * 5 + [0.2, 0.4, 0.02, 0.02, 0.4, 0.4]  # slow for less than 0.1 s
    phases = [reach.phase for reach in follow(speeds)]
    assert "rest" not in phases[5:]
    again = follow([0.01] * 5 + [0.2, 0.4] + [0.02] * 5 + [0.01, 0.3])
    assert again[-2].phase == "rest"
    assert again[-1].onset > 10 / RATE  # a new reach, from where the hand rested


def test_a_tenth_of_the_peak_counts_as_rest():
    phases = [reach.phase for reach in follow([0.01] * 3 + [1.0, 1.5] + [0.12] * 6)]
    assert "rest" in phases[5:]
    phases = [reach.phase for reach in follow([0.01] * 3 + [1.0, 1.5] + [0.2] * 6)]
    assert phases[5:] == ["decelerating"] * 6


def test_peak_speed_and_elapsed_at_rest_are_zero():
    for reach in follow([0.0, 0.05, 0.09]):
        assert (reach.phase, reach.elapsed, reach.peak_speed) == ("rest", 0.0, 0.0)


def test_a_hand_that_is_first_seen_moving_has_a_finite_onset():
    [reach, *_] = follow([0.7, 0.8])
    assert reach.phase == "accelerating"
    assert math.isfinite(reach.onset)
    assert all(map(math.isfinite, reach.start))


def test_it_is_causal():
    rng = np.random.default_rng(3)
    speeds = np.abs(np.cumsum(rng.normal(0.0, 0.08, 120))).tolist()
    whole = follow(speeds)
    for cut in (1, 17, 60, 119):
        assert follow(speeds[:cut]) == whole[:cut]


def test_a_shifted_clock_changes_nothing():
    speeds = [0.01] * 10 + bell() + [0.01] * 10
    config = ReachConfig(dwell=0.09)  # no multiple of the time between two frames
    phases = [reach.phase for reach in follow(speeds, config)]
    detector = ReachDetector(config)
    shifted = [
        detector.update(1e6 + k / RATE, (0.0, 0.0, 0.0), s).phase for k, s in enumerate(speeds)
    ]
    assert shifted == phases
