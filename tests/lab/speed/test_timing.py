"""Contestants are timed by turns."""

import numpy as np
import pytest

from igrip.lab.speed.timing import interleaved, percentiles


def test_interleaving_calls_each_in_turn():
    calls = []
    times = interleaved(
        {"a": lambda k: calls.append(("a", k)), "b": lambda k: calls.append(("b", k))}, range(2)
    )
    assert calls == [("a", 0), ("b", 0), ("a", 1), ("b", 1)]
    assert {name: len(seconds) for name, seconds in times.items()} == {"a": 2, "b": 2}
    assert percentiles(np.array([0.001, 0.002, 0.003]))["p50_ms"] == pytest.approx(2.0)


def test_turns_of_several_frames():
    calls = []
    contestants = {name: lambda k, n=name: calls.append((n, k)) for name in "ab"}
    times = interleaved(contestants, range(3), turn=2)
    assert calls == [("a", 0), ("a", 1), ("b", 0), ("b", 1), ("a", 2), ("b", 2)]
    assert {name: len(seconds) for name, seconds in times.items()} == {"a": 3, "b": 3}
