"""Times from other clocks."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.observation import Observation
from igrip.runtime.clock_sync import PATIENCE, ArrivalStamp, SenderStamp


def message(t, own=None):
    hand = {"position": [0.0, 0.0, 0.0]} | ({} if own is None else {"t": own})
    return Observation(t=t, hands={"right": hand, "left": None})


def test_a_delay_that_varies_is_seen_as_age():
    stamp = ArrivalStamp()
    rng = np.random.default_rng(0)
    extra = rng.exponential(0.02, 200)
    extra[0] = 0.0
    for k, late in enumerate(extra):
        sent = 1e6 + k / 30.0  # another clock, and a way of 40 ms
        seen = stamp.stamp(message(sent), 5.0 + k / 30.0 + 0.04 + late)
        assert seen.t == pytest.approx(5.04 + k / 30.0 + late)
        # it may be taken for a drift of the clock, but hardly
        assert 0.0 <= late + 1e-6 - (seen.t - seen.hands["right"].t) < 0.007
        assert seen.hands["left"] is None


def test_what_was_measured_before_it_was_sent_stays_so_much_older():
    seen = ArrivalStamp().stamp(message(100.0, own=99.9), 7.0)
    assert seen.hands["right"].t == pytest.approx(6.9)


def test_what_is_late_is_late_however_much_and_however_long():
    stamp = ArrivalStamp()
    for k in range(60):
        stamp.stamp(message(50.0 + k / 30.0), 1.0 + k / 30.0)
    for k in range(300):
        seen = stamp.stamp(message(52.0 + k / 30.0), 3.0 + k / 30.0 + 1.2)
        assert seen.t - seen.hands["right"].t > 1.1


def test_a_clock_that_is_set_back_heals_after_some_messages():
    stamp = ArrivalStamp()
    for k in range(30):
        stamp.stamp(message(50.0 + k / 30.0), 1.0 + k / 30.0)
    ages = []
    for k in range(20):
        seen = stamp.stamp(message(3.0 + k / 30.0), 2.0 + k / 30.0)
        ages.append(seen.t - seen.hands["right"].t)
    assert min(ages[: PATIENCE - 1]) > 1.9
    assert ages[PATIENCE:] == pytest.approx([0.0] * (20 - PATIENCE), abs=1e-6)


def test_a_clock_that_drifts_is_followed():
    stamp = ArrivalStamp()
    for k in range(3000):
        now = k / 10.0
        seen = stamp.stamp(message(100.0 + now * 0.9995), 1.0 + now)
    assert seen.t - seen.hands["right"].t < 0.02


def test_the_senders_clock_never_goes_back():
    stamp = SenderStamp()
    assert stamp.stamp(message(10.0), 0.0).t == 10.0
    assert stamp.stamp(message(10.2), 0.1).t == 10.2
    late = stamp.stamp(message(10.1), 0.25)
    assert late.t == pytest.approx(10.2)
    assert late.hands["right"].t == pytest.approx(10.1)


def test_a_senders_clock_that_jumps_ahead_and_back_heals():
    stamp = SenderStamp()
    stamp.stamp(message(5.0), 0.0)
    stamp.stamp(message(1e9), 0.0)
    seen = [stamp.stamp(message(5.1 + k / 30.0), 0.0) for k in range(60)]
    times = [one.t for one in seen]
    assert times == sorted(times)
    ages = [one.t - one.hands["right"].t for one in seen[PATIENCE:]]
    assert max(ages) < 1e-6
    assert times[-1] - times[PATIENCE] == pytest.approx((59 - PATIENCE) / 30.0, rel=1e-6)
