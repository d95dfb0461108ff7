"""Means over trials, counted by hand."""

import numpy as np
import pandas as pd
import pytest

from igrip.lab.evaluation.averages import average_scores, mean, numbers
from igrip.lab.evaluation.trial_metrics import FRACTIONS


def test_what_is_unknown_does_not_count():
    assert mean([1.0, None, 2.0]) == 1.5
    assert mean([True, False, None, True]) == pytest.approx(2 / 3)
    assert mean(pd.Series([True, None, np.nan, False], dtype=object)) == 0.5
    assert mean([]) is mean([None]) is None
    np.testing.assert_equal(numbers([True, None, 3]), [1.0, np.nan, 3.0])


@pytest.mark.parametrize("kind", [dict, pd.DataFrame])
@pytest.mark.parametrize("prefix", ["", "grip_"])
def test_scores(kind, prefix):
    columns = {
        "success": [True, False, True, None], "delay_s": [-0.2, 0.9, 0.4, None],
        "delay_clipped_s": [0.0, 0.9, 0.4, None], "margin_s": [1.0, 0.1, 0.5, None],
    } | {f"right_at_{f:.0%}": [True, f > 0.5, False, None] for f in FRACTIONS}  # fmt: skip
    rows = kind({f"{prefix}{name}": column for name, column in columns.items()})
    assert average_scores(rows, prefix) == {
        "success": pytest.approx(2 / 3), "delay_s": pytest.approx(0.1),
        "delay_clipped_s": pytest.approx(0.2), "margin_s": pytest.approx(0.75),
        "accuracy": {f"{f:.0%}": pytest.approx((1 + (f > 0.5)) / 3) for f in FRACTIONS},
    }  # fmt: skip


def test_nothing_succeeded():
    columns = {"success": [False], "delay_s": [0.3], "delay_clipped_s": [0.3], "margin_s": [0.1]}
    row = average_scores(columns | {f"right_at_{f:.0%}": [False] for f in FRACTIONS})
    assert (row["success"], row["delay_s"], row["margin_s"]) == (0.0, None, None)
