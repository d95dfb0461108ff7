"""The weightings of the four metrics, and the choice of the best."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frames import geometry, motion
from igrip.targets import TARGETS, best_of
from igrip.targets._weighted_cues import METRICS
from igrip.targets.paper import paper_weights
from igrip.targets.repaired import repaired_weights
from oracle import scores

SPEEDS = st.one_of(st.just(0.0), st.floats(1e-3, 3.0))
PEAKS = st.one_of(st.none(), SPEEDS)
COLUMNS = st.lists(st.tuples(*[st.floats(-1.0, 1.0)] * 4), min_size=1, max_size=5)


@given(SPEEDS, PEAKS)
def test_weights(speed, peak):
    assert paper_weights(speed, peak) == pytest.approx(scores.weights("paper", speed, peak))
    assert repaired_weights(speed, peak) == pytest.approx(scores.weights("repaired", speed, peak))
    w0, w1 = paper_weights(speed, peak)
    assert 0.0 <= w0 <= 1.0
    assert w1 in (1.0, 2.0)
    w0, w1 = repaired_weights(speed, peak)
    assert w0 == 1.0
    assert 0.0 <= w1 <= 2.0


@pytest.mark.parametrize(
    ("speed", "peak", "paper", "repaired"),
    [
        (0.5, None, (1.0, 1.0), (1.0, 1.0)),
        (0.0, 0.0, (1.0, 1.0), (1.0, 1.0)),
        (0.0, 0.4, (0.0, 1.0), (1.0, 0.0)),
        (0.2, 0.4, (0.5, 1.0), (1.0, 0.5)),
        (0.4, 0.4, (1.0, 1.0), (1.0, 1.0)),
        (0.6, 0.4, (1.0, 2.0), (1.0, 1.5)),
        (0.9, 0.4, (1.0, 2.0), (1.0, 2.0)),
        (0.3, 0.0, (1.0, 2.0), (1.0, 2.0)),
    ],
)
def test_weights_by_hand(speed, peak, paper, repaired):
    assert paper_weights(speed, peak) == pytest.approx(paper)
    assert repaired_weights(speed, peak) == pytest.approx(repaired)


@pytest.mark.parametrize("kind", ["paper", "repaired"])
@given(columns=COLUMNS, speed=SPEEDS, peak=PEAKS)
def test_weighted_mean(kind, columns, speed, peak):
    table = np.array(columns)
    cues = {name: table[:, k] for k, name in enumerate(METRICS)}
    estimate = TARGETS.get(kind)().update(motion(speed, peak), geometry(len(table)), cues)
    expected = scores.combined(kind, cues, speed, peak)
    assert estimate.scores == pytest.approx(expected, abs=1e-12)
    assert estimate.probability is None
    gap = np.sort(expected)[::-1]
    if gap[0] > 1e-9 and (len(gap) == 1 or gap[0] - gap[1] > 1e-9):
        assert estimate.target == scores.target(expected)


@pytest.mark.parametrize("name", METRICS)
def test_a_single_cue_decides_alone(name):
    cues = {other: np.array([0.9, 0.1, 0.0]) for other in METRICS}
    cues[name] = np.array([0.1, 0.2, 0.15])
    estimate = TARGETS.get(name)().update(motion(), geometry(), cues)
    assert estimate.target == 1
    assert estimate.scores.tolist() == [0.1, 0.2, 0.15]


@pytest.mark.parametrize(
    ("column", "best"),
    [
        ([], None),
        ([0.0], None),
        ([-0.5, -0.1], None),
        ([0.3], 0),
        ([0.1, 0.3, 0.2], 1),
        ([0.3, 0.3], None),
        ([0.3, 0.1, 0.3], None),
        ([0.3, 0.3 + 1e-14], None),
        ([0.3, 0.3 + 1e-9], 1),
        ([1e-300, 0.0], None),  # no more than rounding apart
        ([np.nan, 0.5], None),
        ([np.nan, np.nan], None),
    ],
)
def test_best_of(column, best):
    assert best_of(np.array(column, dtype=float)) == best


@given(st.lists(st.floats(-1.0, 1.0), max_size=8), st.integers(0, 999))
def test_best_of_does_not_depend_on_the_order(column, seed):
    column = np.array(column)
    order = np.random.default_rng(seed).permutation(len(column))
    a, b = best_of(column), best_of(column[order])
    assert (a is None) == (b is None)
    if a is not None:
        assert order[b] == a


def test_an_estimator_gives_its_scores_away_without_sharing_them():
    cues = {name: np.array([0.5, 0.2]) for name in METRICS}
    estimator = TARGETS.get("repaired")()
    first = estimator.update(motion(), geometry(2), cues)
    first.scores[:] = 9.0
    second = estimator.update(motion(), geometry(2), cues)
    assert second.scores.max() < 1.0
