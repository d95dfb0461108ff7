"""Times from other clocks."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.observation import Observation
from igrip.runtime.clock_sync import (
    STEP_MESSAGES,
    ArrivalClock,
    ClockOffset,
    RunClock,
    SenderClock,
)


def message(t, own=None):
    hand = {"position": [0.0, 0.0, 0.0]} | ({} if own is None else {"t": own})
    return Observation(t=t, hands={"right": hand, "left": None})


class Arrivals:
    """Messages of one sender on the clock of arrival."""

    def __init__(self):
        self.clock, self.offset = ArrivalClock(clock=lambda: 0.0), ClockOffset()

    def stamp(self, message, arrived):
        return self.clock.stamp(message, arrived, self.offset)


def on_senders_clock(clock, message):
    return clock.stamp(message, 1e6, ClockOffset())  # its arrival is of no account


def test_a_delay_that_varies_is_seen_as_age():
    stamp = Arrivals()
    rng = np.random.default_rng(0)
    extra = rng.exponential(0.02, 200)
    extra[0] = 0.0
    arrived = 0.0
    for k, late in enumerate(extra):
        sent = 1e6 + k / 30.0  # another clock, and a way of 40 ms
        arrived = max(arrived, 5.04 + k / 30.0 + late)
        late = arrived - (5.04 + k / 30.0)
        stamped = stamp.stamp(message(sent), arrived)
        assert stamped.t == pytest.approx(arrived)
        # it may be taken for a drift of the clock, but hardly
        assert 0.0 <= late + 1e-6 - (stamped.t - stamped.hands["right"].t) < 0.007
        assert stamped.hands["left"] is None


def test_what_was_measured_before_it_was_sent_stays_so_much_older():
    seen = Arrivals().stamp(message(100.0, own=99.9), 7.0)
    assert seen.hands["right"].t == pytest.approx(6.9)


def test_what_is_late_is_late_however_much_and_however_long():
    stamp = Arrivals()
    for k in range(60):
        stamp.stamp(message(50.0 + k / 30.0), 1.0 + k / 30.0)
    for k in range(300):
        seen = stamp.stamp(message(52.0 + k / 30.0), 3.0 + k / 30.0 + 1.2)
        assert seen.t - seen.hands["right"].t > 1.1


def test_a_clock_that_is_set_back_heals_after_some_messages():
    stamp = Arrivals()
    for k in range(30):
        stamp.stamp(message(50.0 + k / 30.0), 1.0 + k / 30.0)
    ages = []
    for k in range(20):
        seen = stamp.stamp(message(3.0 + k / 30.0), 2.0 + k / 30.0)
        ages.append(seen.t - seen.hands["right"].t)
    assert min(ages[: STEP_MESSAGES - 1]) > 1.9
    assert ages[STEP_MESSAGES:] == pytest.approx([0.0] * (20 - STEP_MESSAGES), abs=1e-6)


def test_a_clock_that_drifts_is_followed():
    stamp = Arrivals()
    for k in range(3000):
        now = k / 10.0
        seen = stamp.stamp(message(100.0 + now * 0.9995), 1.0 + now)
    assert seen.t - seen.hands["right"].t < 0.02


def test_the_senders_clock_never_goes_back():
    clock = SenderClock()
    for t in (10.0, 10.2):
        assert on_senders_clock(clock, message(t)) == message(t)
        assert clock.now() == t
    late = on_senders_clock(clock, message(10.1))
    assert late.t == clock.now() == pytest.approx(10.2)
    assert late.hands["right"].t == pytest.approx(10.1)


def test_a_senders_clock_that_jumps_ahead_and_back_heals():
    clock = SenderClock()
    on_senders_clock(clock, message(5.0))
    on_senders_clock(clock, message(1e9))
    seen = [on_senders_clock(clock, message(5.1 + k / 30.0)) for k in range(60)]
    times = [one.t for one in seen]
    assert times == sorted(times)
    ages = [one.t - one.hands["right"].t for one in seen[STEP_MESSAGES:]]
    assert max(ages) < 1e-6
    assert times[-1] - times[STEP_MESSAGES] == pytest.approx((59 - STEP_MESSAGES) / 30.0, rel=1e-6)


def test_messages_of_this_machine_keep_their_times_unless_they_come_late():
    now = [7.0]
    clock = RunClock(begin=5.0, clock=lambda: now[0])
    assert clock.now() == 2.0
    assert clock.stamp(message(1.9, own=1.8), 2.0, ClockOffset()) == message(1.9, own=1.8)
    clock.stamp(Observation(t=2.0), 2.0, ClockOffset())  # a tick
    late = clock.stamp(message(1.95), 2.1, ClockOffset())
    assert (late.t, late.hands["right"].t) == (2.0, 1.95)


def test_a_message_that_arrived_just_before_a_tick_comes_after_it():
    arrivals = Arrivals()
    arrivals.clock.stamp(Observation(t=1.0), 1.0, ClockOffset())
    assert arrivals.stamp(message(50.0), 0.999).t == 1.0
