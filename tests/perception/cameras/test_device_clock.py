"""The clock of a camera: steps are followed, delays stay, odd times cost their frames."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.perception.cameras._device_clock import DeviceClock

DELAY = 0.04  # s from exposure to arrival


def ages(step=0.0, rate=30.0, jitter=0.004, seed=0, odd=None, loss=0.0):
    """Return the clock, and times and errors of the dated frames [s]; the step is at 4 s."""
    random = np.random.default_rng(seed)
    clock, found = DeviceClock("cam"), []
    for k, taken in enumerate(np.arange(0.0, 8.0, 1.0 / rate).tolist()):
        if random.random() < loss:
            continue
        arrived = 100.0 + taken + DELAY + jitter * random.random()
        told = 100.0 + taken + (step if taken >= 4.0 else 0.0) + (500.0 if k == odd else 0.0)
        t = clock.update(told, arrived)
        found.append((taken, None if t is None else t - 100.0 - taken))
    return clock, found


@pytest.mark.parametrize("rate", [10.0, 15.0, 30.0, 60.0])
@pytest.mark.parametrize("step", [0.3, 1.0, 60.0, 1e6, -0.3, -1.0, -60.0, -90.0])
@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_a_step_is_followed_within_two_seconds_and_the_delay_is_kept(step, rate, loss):
    clock, found = ages(step, rate, loss=loss, seed=3)
    after = [error for taken, error in found if taken > 6.0]
    assert None not in after
    assert np.abs(after).max() < 0.03 + (2.0 / rate if loss else 0.0)
    before = [error for taken, error in found if taken < 4.0]
    assert np.abs(before).max() < 1e-9
    assert f"stepped {'ahead' if step > 0 else 'back'}" in clock.event


@pytest.mark.parametrize("seed", range(5))
def test_without_a_step_times_stay_as_they_are(seed):
    clock, found = ages(seed=seed, jitter=0.03, loss=0.2)
    assert all(error == pytest.approx(0.0, abs=1e-9) for _, error in found)
    assert clock.event is None


@pytest.mark.parametrize("odd", [1, 4, 20, 60])
def test_one_odd_time_costs_few_frames(odd):
    clock, found = ages(odd=odd, jitter=0.0)
    errors = [error for _, error in found]
    assert sum(error is None for error in errors) <= 8
    assert all(error is None or abs(error) < 1e-3 for error in errors)
    assert clock.event is None
