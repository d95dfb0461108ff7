"""What is drawn for training holds what the frozen cohorts are, and is wider."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.lab.simulation.parameters import cohort_parameters
from training.worlds import draw_world

PARTS = ("protocol", "person", "camera")


def numbers(world):
    """Return every number of a world by its name."""
    return {
        f"{part}.{name}": value
        for part in PARTS
        for name, value in getattr(world, part).model_dump().items()
        if isinstance(value, (int, float))
    }


@pytest.fixture(scope="module")
def drawn():
    random = np.random.default_rng(0)
    return [numbers(draw_world(random)) for _ in range(600)]


@pytest.mark.parametrize("profile", ["healthy", "stroke", "sci"])
def test_the_cohorts_that_judge_lie_within_what_is_drawn(drawn, profile):
    """Some are at the very edge of the range, which no draw quite reaches."""
    outside = {
        name: value
        for name, value in numbers(cohort_parameters(profile)).items()
        if name != "protocol.repetitions"
        and not 0.99 * min(w[name] for w in drawn) <= value <= 1.01 * max(w[name] for w in drawn)
    }
    assert not outside


def test_most_of_what_a_sensor_does_is_varied(drawn):
    fixed = {name for name in drawn[0] if len({w[name] for w in drawn}) == 1}
    sensor = {name for name in drawn[0] if name.startswith("camera.")}
    assert len(sensor - fixed) > 0.7 * len(sensor)
