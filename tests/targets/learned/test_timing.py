"""Predicted times of contact and of the end."""

from __future__ import annotations

import json

import numpy as np
import pytest

from igrip.errors import IgripError
from igrip.targets.learned.timing import (
    FILE,
    INPUTS,
    QUANTILES,
    Prediction,
    TimingModel,
    read_timing,
)
from training.timing import TimingSamples, fit_timing


def test_seen_later_the_times_are_shorter_and_never_negative():
    assert Prediction(0.1, 0.3, 0.6).after(0.2) == (0.0, pytest.approx(0.1), pytest.approx(0.4))
    assert Prediction(0.1, 0.3, 0.6).interval == (0.1, 0.6)


def test_the_network_against_numpy():
    random = np.random.default_rng(0)
    width, units, outputs = len(INPUTS), 5, 2 * len(QUANTILES)
    model = TimingModel(
        random.normal(size=width), random.uniform(0.5, 2.0, width),
        random.normal(size=(width, units)) / 6, random.normal(size=units),
        random.normal(size=(units, outputs)), random.normal(size=outputs),
    )  # fmt: skip
    inputs = 5.0 * random.normal(size=width)
    z = np.clip((inputs - model.mean) / model.scale, -4.0, 4.0)
    logs = np.tanh(z @ model.hidden + model.bias) @ model.out_weights + model.out_bias
    timing = model.evaluate(inputs)
    assert timing.contact == pytest.approx(np.sort(np.exp(logs[:3])))
    assert timing.end == pytest.approx(np.sort(np.exp(logs[3:])))


def test_the_fit_finds_the_quantiles():
    """The times depend on one input, and spread by a known factor."""
    random = np.random.default_rng(0)
    inputs = np.zeros((6000, len(INPUTS)))
    inputs[:, 3] = random.normal(size=6000)
    spread = random.normal(size=6000)
    times = np.exp(-1.0 + 0.3 * inputs[:, 3] + 0.5 * spread)
    samples = TimingSamples(inputs, np.column_stack([times, 2.0 * times]), np.ones(6000))
    model = fit_timing([samples], seed=1)
    fresh = np.zeros((300, len(INPUTS)))
    fresh[:, 3] = random.normal(size=300)
    found = np.log([[*model.evaluate(x).contact, *model.evaluate(x).end] for x in fresh])
    for k, z in enumerate((-1.2816, 0.0, 1.2816)):
        expected = -1.0 + 0.3 * fresh[:, 3] + 0.5 * z
        assert np.median(np.abs(found[:, k] - expected)) < 0.1
        assert np.median(np.abs(found[:, 3 + k] - expected - np.log(2.0))) < 0.1


def test_what_ships_can_be_read():
    model = read_timing(FILE)
    assert model.hidden.shape[0] == len(INPUTS)
    timing = model.evaluate(model.mean)
    assert 0.0 < timing.contact.low < timing.contact.median < timing.contact.high < 5.0


def test_a_file_for_other_inputs_is_refused(tmp_path):
    content = json.loads(FILE.read_text())
    path = tmp_path / "timing.json"
    path.write_text(json.dumps(content | {"inputs": ["speed"]}))
    with pytest.raises(IgripError, match="made for other inputs"):
        read_timing(path)
