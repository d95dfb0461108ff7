"""The training: right gradients, an answer that no last digit changes, and a problem it solves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from igrip.targets.bayes import WEIGHTS
from igrip.targets.learned.features import LOCAL, SHARED, Features
from igrip.targets.learned.network import INPUTS, read_scorer
from training import learn
from training.grip import fit_grip, terms_of
from training.learn import fit, fit_scorer, inputs_of, scores_of, standardised, write_scorer
from training.logit import fit_logit, linear, logit_scores
from training.moments import Moments, joined, thinned

PROGRESS = LOCAL.index("progress")


def toy(frames=400, seed=0, part=0.8):
    """Return moments in which the object that is further on is the target, sometimes none."""
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, 5, frames)
    frame = np.repeat(np.arange(frames), counts)
    local = rng.normal(size=(len(frame), len(LOCAL)))
    first = np.cumsum(counts) - counts
    target = np.array(
        [f + np.argmax(local[f : f + n, PROGRESS]) for f, n in zip(first, counts, strict=True)]
    )
    target = np.where(rng.random(frames) < part, target, -1)
    weight = rng.uniform(0.5, 2.0, frames)
    return Moments(local, frame, rng.normal(size=(frames, len(SHARED))), target, weight,
                   np.arange(frames), np.full(frames, 0.5))  # fmt: skip


@pytest.mark.parametrize("none", [True, False])
def test_gradients_are_those_of_the_loss(none):
    moments, rng = toy(30, part=0.8 if none else 1.0), np.random.default_rng(1)
    x = inputs_of(moments)
    values = [rng.normal(size=s) * 0.3 for s in ((len(INPUTS), 3), (3,), (3,), (1,))]

    def at(values):
        return learn._gradients(x, moments.frame, moments.target, moments.weight, values, none)

    def loss(values):
        return at(values)[1]

    gradients, _ = at(values)
    for k, gradient in enumerate(gradients):
        for index in list(np.ndindex(gradient.shape))[:: max(1, gradient.size // 7)]:
            above, below = ([v.copy() for v in values] for _ in range(2))
            above[k][index] += 1e-5
            below[k][index] -= 1e-5
            slope = (loss(above) - loss(below)) / 2e-5 / moments.weight.sum()
            assert gradient[index] == pytest.approx(slope, rel=1e-4, abs=1e-7)


def test_it_learns_what_there_is_to_learn():
    scorer, _ = fit_scorer(toy(12000), 0.02, seed=0)
    unseen = toy(500, seed=9, part=1.0)
    scores = scores_of(scorer, inputs_of(unseen), unseen.frame)
    best = [
        np.flatnonzero(unseen.frame == n)[np.argmax(scores[unseen.frame == n])] for n in range(500)
    ]
    assert np.mean(np.array(best) == unseen.target) > 0.9


def test_last_digits_are_rounded_away():
    """Another machine's sums differ in the sixteenth digit; the weights must not."""
    moments = toy(2500)
    other = replace(moments, weight=moments.weight * (1.0 + 1e-13))
    first, again = (
        fit(standardised(inputs_of(m))[0], m, seed=3, none=True, units=6)[0]
        for m in (moments, other)
    )
    assert (first.hidden == again.hidden).all()
    assert (first.out_weights == again.out_weights).all()


def test_the_file_holds_every_digit(tmp_path):
    shipped = read_scorer(WEIGHTS)
    write_scorer(shipped, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_text() == WEIGHTS.read_text()
    x, frame = np.random.default_rng(0).normal(size=(50, len(INPUTS))), np.arange(50) // 5
    assert (
        scores_of(read_scorer(tmp_path / "again.json"), x, frame) == scores_of(shipped, x, frame)
    ).all()


def test_thinned_moments_keep_the_weight_and_the_targets():
    moments = joined([toy(900, seed=1), toy(900, seed=2)])
    kept = thinned(moments, 0)
    assert kept.weight.sum() == pytest.approx(moments.weight.sum(), rel=0.1)
    assert (kept.frame[kept.target[kept.target >= 0]] == np.flatnonzero(kept.target >= 0)).all()
    for n in np.flatnonzero(kept.target >= 0)[::50]:
        rows = np.flatnonzero(kept.frame == n)
        assert kept.target[n] == rows[np.argmax(kept.local[rows, PROGRESS])]


def test_the_logit_finds_the_maximum():
    moments = toy(1200)
    x, mean, scale = learn.standardised(inputs_of(moments))
    weights = fit_logit(x, moments)
    scores = logit_scores(inputs_of(moments), mean, scale, weights)
    best = [
        np.flatnonzero(moments.frame == n)[np.argmax(scores[moments.frame == n])]
        for n in range(1200)
    ]
    hit = moments.target >= 0
    assert np.mean((np.array(best) == moments.target)[hit]) > 0.85
    assert linear(x).shape[1] == len(weights)


def test_the_grip_is_fitted_to_its_maximum():
    rng = np.random.default_rng(0)
    inputs = rng.normal(size=(4000, 6))
    pinch = rng.random(4000) < 1.0 / (1.0 + np.exp(-(1.0 - 2.0 * inputs[:, 1])))
    weights = fit_grip([np.column_stack([inputs, pinch, np.ones(4000)])])
    assert weights["1"] == pytest.approx(1.0, abs=0.2)
    assert weights["height_soon"] == pytest.approx(-2.0, abs=0.25)
    likely = 1.0 / (1.0 + np.exp(-terms_of(inputs) @ np.array(list(weights.values()))))
    slope = terms_of(inputs).T @ (likely - pinch) + np.array(list(weights.values()))
    assert np.abs(slope).max() < 0.1


def test_training_and_use_read_the_weights_alike():
    shipped, moments = read_scorer(WEIGHTS), toy(40)
    together = scores_of(shipped, inputs_of(moments), moments.frame)
    for n in range(40):
        rows = moments.frame == n
        alone = shipped.score(Features(moments.local[rows], moments.shared[n]))
        assert together[rows] == pytest.approx(alone, rel=1e-9)
