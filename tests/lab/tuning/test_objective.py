"""The value of trials, worked out on paper."""

import math

import numpy as np
import pytest

from igrip.lab.tuning.objective import score, trial_values
from igrip.lab.tuning.outcomes import Outcomes

NONE = (math.nan, math.nan, math.nan, math.nan)


def test_the_value_of_each_kind_of_trial():
    rows = [
        (0.4, 1.0, math.nan, math.nan),  # right, without a stated probability: 1 - 0.4 / 2
        (0.4, 0.0, math.nan, math.nan),  # wrong: what 19 late right ones are worth
        NONE,
        (math.nan, math.nan, math.nan, 2.0),  # two leases without a reach
        (0.4, 1.0, 0.8, math.nan),  # of four reaches: q = (4 · 1 + 4 · 0.8) / 8 = 0.9
    ]
    assert trial_values(Outcomes.of(rows)) == pytest.approx(
        [0.8, -9.5, 0.0, -19.0, 0.9 * 0.8 - 9.5 * 0.1]
    )


def test_a_commitment_at_the_end_breaks_even_at_95_percent():
    rows = [(1.0, 1.0, math.nan, math.nan)] * 19 + [(1.0, 0.0, math.nan, math.nan)]
    assert trial_values(Outcomes.of(rows)).sum() == pytest.approx(0.0)


def test_more_reaches_outweigh_what_the_estimator_states():
    few, many = (Outcomes.of([(0.5, 1.0, 0.6, math.nan)] * n) for n in (8, 200))
    assert trial_values(few)[0] < 0.0 < trial_values(many)[0] < 0.75


def test_the_score_is_that_without_the_fold_that_helps_most():
    rows = [(0.0, 1.0, math.nan, math.nan)] * 2 + [NONE] * 2
    assert score(Outcomes.of(rows), np.array([0, 0, 1, 1])) == 0.0
    assert score(Outcomes.of(rows), np.array([0, 1, 0, 1])) == pytest.approx(0.5)
    assert score(Outcomes.of(rows), np.zeros(4, dtype=int)) == pytest.approx(0.5)
