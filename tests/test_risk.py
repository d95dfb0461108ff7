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


def test_an_accepted_error_replaces_the_threshold_of_the_reliability():
    careful = CommitmentConfig(max_wrong=0.05)
    assert careful.threshold_in(0.5) == default_risk().threshold(0.05, 0.5)
    assert careful.threshold_in(0.0) >= careful.threshold_in(0.5)
    assert careful.threshold_in(None) == CommitmentConfig().threshold


def test_a_table_that_does_not_increase_is_refused(tmp_path):
    content = json.loads(FILE.read_text())
    path = tmp_path / "risk.json"
    path.write_text(json.dumps(content | {"max_wrong": [0.1] * len(content["max_wrong"])}))
    with pytest.raises(IgripError, match="must be positive and increase"):
        read_risk(path)
