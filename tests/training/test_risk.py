"""Learn-then-test on counts that can be checked by hand."""

from __future__ import annotations

import numpy as np
from scipy.stats import binom

from training.risk import DELTA, MAX_WRONG, THRESHOLDS, Commitments, thresholds


def source(count, wrong_below, familiarity=1.0):
    """Reaches that are committed to wrongly at every threshold below a reach's own."""
    wrong = (THRESHOLDS[None, :] < np.asarray(wrong_below)[:, None]).astype(float)
    assert len(wrong) == count
    return Commitments(wrong, np.full_like(wrong, familiarity), np.zeros_like(wrong))


def test_the_lowest_threshold_that_stands():
    """20 of 400 reaches are wrong below 0.8, 100 of them below 0.7."""
    one = source(400, [0.8] * 20 + [0.7] * 80 + [0.0] * 300)
    found = dict(zip(MAX_WRONG, thresholds([one], strange=False), strict=True))
    assert binom.cdf(20, 400, 0.1) < DELTA < binom.cdf(20, 400, 0.05)
    assert found[0.05] == 0.8
    assert found[0.1] == 0.7
    assert found[0.01] == 0.8


def test_the_hardest_source_decides():
    easy, hard = source(400, [0.0] * 400), source(400, [0.9] * 100 + [0.0] * 300)
    assert (thresholds([easy, hard], strange=False) >= thresholds([easy], strange=False)).all()
    assert thresholds([easy, hard], strange=False)[2] == 0.9


def test_strange_movements_are_calibrated_apart():
    strange = source(400, [0.9] * 100 + [0.0] * 300, familiarity=0.05)
    familiar = source(400, [0.0] * 400)
    assert thresholds([familiar, strange], strange=True)[2] >= 0.9


def test_too_few_reaches_show_nothing():
    assert thresholds([source(5, [0.0] * 5)], strange=False)[0] == THRESHOLDS[-1]


def test_rare_commitments_at_the_highest_thresholds_do_not_end_the_search():
    """Nothing is certain enough for 0.99, where a test has nothing to count."""
    wrong = np.zeros((400, len(THRESHOLDS)))
    wrong[:, THRESHOLDS > 0.9] = np.nan
    one = Commitments(wrong, np.ones_like(wrong), np.zeros_like(wrong))
    assert thresholds([one], strange=False)[2] == THRESHOLDS[0]
