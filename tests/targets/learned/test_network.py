"""The network against plain numpy; clutter elsewhere; files that are none of ours."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.special import logsumexp

import igrip
from igrip.errors import IgripError
from igrip.targets.bayes import WEIGHTS, default_scorer
from igrip.targets.learned.features import LOCAL, SHARED, Features
from igrip.targets.learned.network import (
    HEADING,
    INPUTS,
    MAX_DEFICIT,
    MAX_INPUT,
    RIVAL_SHARPNESS,
    arrange_inputs,
    read_scorer,
)


@pytest.fixture(scope="module")
def scorer():
    return read_scorer(WEIGHTS)


def some(rng, objects=4):
    local = rng.normal(size=(objects, len(LOCAL)))
    local[:, HEADING] = rng.uniform(-1.0, 1.0, objects)
    return local, rng.normal(size=len(SHARED))


def oracle(layers, local, shared):
    weight = np.exp(RIVAL_SHARPNESS * local[:, HEADING])
    rivals = weight @ local / weight.sum()
    inputs = np.hstack([local, local - rivals, np.tile(shared, (len(local), 1))])
    z = np.clip((inputs - layers.mean) / layers.scale, -MAX_INPUT, MAX_INPUT)
    outputs = np.tanh(z @ layers.hidden + layers.bias) @ layers.out_weights + layers.out_bias
    target, reach = outputs.T
    target = target + np.minimum(0.0, reach - reach.max() + MAX_DEFICIT)
    return target - logsumexp(target) + logsumexp(reach)


@pytest.mark.parametrize("objects", [0, 1, 4, 100])
def test_scores_are_those_of_plain_numpy(scorer, objects):
    local, shared = some(np.random.default_rng(objects), objects)
    expected = oracle(scorer.layers, local, shared) if objects else np.empty(0)
    assert scorer.score(Features(local, shared)) == pytest.approx(expected, rel=1e-9)


def test_order_changes_nothing_but_the_order(scorer):
    local, shared = some(np.random.default_rng(5))
    order = [3, 1, 0, 2]
    turned = scorer.score(Features(local[order], shared))
    assert turned == pytest.approx(scorer.score(Features(local, shared))[order])


def test_objects_behind_are_no_rivals():
    rng = np.random.default_rng(6)
    local, shared = some(rng, 2)
    local[:, HEADING] = 0.98
    behind = rng.normal(size=(90, len(LOCAL)))
    behind[:, HEADING] = -0.5
    few, many = np.empty((2, len(INPUTS))), np.empty((92, len(INPUTS)))
    arrange_inputs(local, shared, few)
    arrange_inputs(np.concatenate([local, behind]), shared, many)
    assert many[:2] == pytest.approx(few, abs=1e-3)


def test_the_file_says_where_its_numbers_come_from(scorer):
    told = scorer.provenance
    assert "folds of people" in told["real"]
    assert {Path(name).name for name in told["tables"]} == {"reaches.parquet", "trials.parquet"}
    assert WEIGHTS.stat().st_size < 120_000


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "cannot be read"),
        ("[]", "is not of the format"),
        ('{"format": "igrip-scorer/1"}', "is not of the format"),
        (
            json.dumps({"format": "igrip-scorer/2", "inputs": {"height": {}}}),
            "made for other inputs",
        ),
    ],
)
def test_a_file_that_is_not_ours_is_refused(tmp_path, text, message):
    (tmp_path / "w.json").write_text(text)
    with pytest.raises(IgripError, match=message):
        read_scorer(tmp_path / "w.json")


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("bias", [0.0] * 4048, "hidden is not finite, or not of the shape"),
        ("out_weights", [0.1] * 3, "out_weights is not finite, or not of the shape"),
        ("out_weights", None, "out_weights is not finite, or not of the shape"),
        ("out_bias", float("nan"), "out_bias is not finite"),
        ("memory_s", 0.0, "must be positive"),
        ("memory_s", "long", "has no numbers memory_s"),
        ("inputs", {}, "made for other inputs"),
    ],
)
def test_numbers_that_compiled_code_would_misread_are_refused(tmp_path, key, value, message):
    told = json.loads(WEIGHTS.read_text()) | {key: value}
    (tmp_path / "w.json").write_text(json.dumps(told))
    with pytest.raises(IgripError, match=message):
        read_scorer(tmp_path / "w.json")


def test_a_scale_must_be_positive(tmp_path):
    told = json.loads(WEIGHTS.read_text())
    told["inputs"]["progress"]["scale"] = 0.0
    (tmp_path / "w.json").write_text(json.dumps(told))
    with pytest.raises(IgripError, match="must be positive"):
        read_scorer(tmp_path / "w.json")


def test_bad_weights_are_told_before_the_first_message(tmp_path, shapes, monkeypatch):
    monkeypatch.setattr("igrip.targets.bayes.WEIGHTS", tmp_path / "gone.json")
    default_scorer.cache_clear()
    try:
        with pytest.raises(IgripError, match="cannot be read"):
            igrip.Estimator(shapes, igrip.Config(targets="bayes"))
    finally:
        default_scorer.cache_clear()
