"""Rates, durations and ages of repeated work."""

from __future__ import annotations

import pytest

from igrip.runtime import latency
from igrip.runtime.latency import LatencyMeter


def test_summary_and_rate():
    meter = LatencyMeter()
    assert meter.summary() == {"count": 0}
    assert meter.rate(0.0) == 0.0
    for k in range(101):
        meter.add(now=0.1 * k, duration=0.001 * k, age=0.01)
    assert meter.summary() == {
        "count": 101, "duration_p50_ms": 50.0, "duration_p99_ms": 99.0,
        "age_p50_ms": 10.0, "age_p99_ms": 10.0,
    }  # fmt: skip
    assert meter.rate(10.0) == pytest.approx(10.0, abs=0.51)
    assert meter.rate(20.0) == 0.0


def test_only_the_newest_ages_are_kept(monkeypatch):
    monkeypatch.setattr(latency, "MAX_SAMPLES", 3)
    meter = LatencyMeter()
    for k in range(5):
        meter.add(0.0, 0.0, float(k))
    assert meter.ages() == [2.0, 3.0, 4.0]
    assert meter.count == 5
