import itertools
import math

import numpy as np
import pytest

from igrip.lab.tuning.front import front, point
from igrip.lab.tuning.outcomes import Outcomes


def drawn(random):
    """Return outcomes of 12 reaches and one recording without any."""
    rows = []
    for _ in range(12):
        given = random.random() < 0.8
        part, right = random.random(), float(random.random() < 0.7)
        rows.append((part, right, 0.9, math.nan) if given else (math.nan,) * 4)
    return Outcomes.of([*rows, (math.nan, math.nan, math.nan, float(random.integers(3)))])


def test_no_candidate_beats_a_point_of_the_front_and_some_point_beats_every_other():
    random = np.random.default_rng(0)
    known = {(("commitment.reliability", k / 40),): drawn(random) for k in range(40)}
    best = front(known, idle_minutes=2.0)
    every = [point(dict(values), outcomes, 2.0) for values, outcomes in known.items()]
    for one, other in itertools.product(best, every):
        assert not (other.wrong <= one.wrong and other.part < one.part)
        assert not (other.wrong < one.wrong and other.part <= one.part)
    assert all(any(b.wrong <= p.wrong and b.part <= p.part for b in best) for p in every)
    assert [b.wrong for b in best] == sorted(b.wrong for b in best)


def test_a_point_in_numbers():
    nan = math.nan
    rows = [(0.2, 1.0, 0.9, nan), (0.4, 0.0, 0.9, nan), (nan,) * 4, (nan, nan, nan, 3.0)]
    one = point({}, Outcomes.of(rows), idle_minutes=1.5)
    assert one.committed == pytest.approx(2 / 3)
    assert one.right == 0.5
    assert one.part == pytest.approx((0.2 + 0.4 + 1.0) / 3)
    assert one.wrong == pytest.approx((1 + 3) / 4)
    assert one.false_per_minute == pytest.approx(2.0)
    nothing = point({}, Outcomes.of([(nan,) * 4]), idle_minutes=0.0)
    assert (nothing.committed, nothing.right, nothing.false_per_minute) == (0.0, None, None)
