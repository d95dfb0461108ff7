"""Thresholds by the accepted share of wrong commitments."""

from __future__ import annotations

import json

import numpy as np
import pytest

from igrip.commitment import CommitmentConfig
from igrip.errors import IgripError
from igrip.risk import FILE, FULL_FAMILIARITY, RiskTable, default_risk, read_risk

TABLE = RiskTable(np.array([0.01, 0.1]), np.array([0.9, 0.6]), np.array([1.0, 0.8]))


def test_the_threshold_lies_between_familiar_and_strange():
    assert TABLE.threshold(0.1, 1.0) == pytest.approx(0.6)
    assert TABLE.threshold(0.1, FULL_FAMILIARITY) == pytest.approx(0.6)
    assert TABLE.threshold(0.1, 0.5 * FULL_FAMILIARITY) == pytest.approx(0.7)
    assert TABLE.threshold(0.1, 0.0) == pytest.approx(0.8)


def test_shares_are_interpolated_by_their_logarithm():
    assert TABLE.threshold(np.sqrt(0.001), 1.0) == pytest.approx(0.75)
    assert TABLE.threshold(0.001, 1.0) == pytest.approx(0.9)
    assert TABLE.threshold(0.5, 1.0) == pytest.approx(0.6)


def test_what_ships_asks_for_more_where_less_is_accepted_or_less_is_known():
    shipped = default_risk()
    for column in (shipped.familiar, shipped.strange):
        assert (np.diff(column) <= 0.0).all()
        assert ((column >= 0.5) & (column < 1.0)).all()
    assert (shipped.strange >= shipped.familiar - 1e-9).all()


def test_a_reliability_rules_where_the_user_sets_one():
    default, reliable = CommitmentConfig(), CommitmentConfig(reliability=0.7)
    both = CommitmentConfig(reliability=0.7, max_wrong=0.05)
    assert default.threshold(0.5) == default_risk().threshold(0.05, 0.5)
    assert default.threshold() == pytest.approx(0.5 + 0.45 * 0.48)
    assert reliable.max_wrong is None
    assert reliable.threshold(0.5) == pytest.approx(0.5 + 0.7 * 0.48)
    assert both.threshold(0.5) == default.threshold(0.5)


def test_a_table_that_does_not_increase_is_refused(tmp_path):
    content = json.loads(FILE.read_text())
    path = tmp_path / "risk.json"
    path.write_text(json.dumps(content | {"max_wrong": [0.1] * len(content["max_wrong"])}))
    with pytest.raises(IgripError, match="must be positive and increase"):
        read_risk(path)
